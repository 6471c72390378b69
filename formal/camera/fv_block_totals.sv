// SPDX-License-Identifier: Apache-2.0
// fv_block_totals: a word with each block that is complete, 3 enabled clocks later, with the totals of its pixels.
//
// An arbitrary block column of a frame is followed (`pick` is free). The specification adds up whole rows from the
// beginning of the frame and takes the difference of what it has at the ends of two blocks, modulo the width of a total.
// ram_check watches the memory.

parameter int Columns = 4, Numerator = 5, Denominator = 2, Width = 1, Bayer = 1;
parameter int Totals = 0;  // 1: totals too
input logic [1:0] pick;

localparam int Lanes = Bayer != 0 ? 2 : 3;

bind dut.u_line ram_check #(.Depth(Depth)) u_check (.*);

wire [7:0] column = u_protocol.column;

// Where the row ends, from the beginning of its block; its part in the block.
logic [BlockWidth:0] begin_q, begins, ends;
logic block_ends;
logic [BlockWidth-1:0] part, red_rows, red_rows_q, red_come, red_until, red_come_q, red_until_q;
assign begins = in_frame_start ? '0 : begin_q;
assign ends = begins + (BlockWidth + 1)'(Denominator);
assign block_ends = ends >= (BlockWidth + 1)'(Numerator);
assign part = block_ends ? BlockWidth'(Numerator) - BlockWidth'(begins) : BlockWidth'(Denominator);
logic row_ends_block;
logic [BlockWidth-1:0] row_part;
logic [BlockWidth-1:0] part_now;
logic ends_now;
assign part_now = in_row_start ? part : row_part;
assign ends_now = in_row_start ? block_ends : row_ends_block;
assign red_come = in_frame_start ? '0 : red_come_q;  // modulo their width, as the totals below
assign red_until = in_frame_start ? '0 : red_until_q;
assign red_rows = in_row_start ? red_come + (in_blue_row ? '0 : part) - red_until : red_rows_q;

// Of the block column that is followed: what has come since the frame began, and what had when its last block ended.
logic [1:0] followed;
logic watched, fresh_column;
logic [3*TotalWidth-1:0] come_q, until_q, come, totals;
assign watched = in_ends && column == 8'(followed);
always_comb begin
  for (int c = 0; c < 3; c++) begin
    logic [SumWidth-1:0] sum;
    logic counts;
    counts = Bayer == 0 || c == 1 || in_blue_row == (c == 2);
    if (Bayer == 0) sum = in_sums[c%Lanes*SumWidth+:SumWidth];
    else if (c == 1) sum = in_blue_row ? in_sums[0+:SumWidth] : in_sums[SumWidth+:SumWidth];
    else sum = in_sums[c/2*SumWidth+:SumWidth];
    come[c*TotalWidth+:TotalWidth] = counts ? TotalWidth'($signed(sum)) : '0;
    totals[c*TotalWidth+:TotalWidth] = (fresh_column ? '0 : come_q[c*TotalWidth+:TotalWidth])
        + TotalWidth'(part_now) * come[c*TotalWidth+:TotalWidth]
        - (fresh_column ? '0 : until_q[c*TotalWidth+:TotalWidth]);
  end
end
logic first_row;  // of the frame; the present row if it begins now
assign fresh_column = in_row_start ? in_frame_start : first_row;

logic [2:0] due, due_watched;
logic [9*TotalWidth-1:0] due_totals;
logic [3*BlockWidth-1:0] due_red_rows, due_red_columns;
always_ff @(posedge clk) begin
  if (!started) followed <= pick;
  if (en) begin
    due <= {due[1:0], in_ends & ends_now};
    due_watched <= {due_watched[1:0], watched};
    due_totals <= {due_totals[6*TotalWidth-1:0], totals};
    due_red_rows <= {due_red_rows[2*BlockWidth-1:0], red_rows};
    due_red_columns <= {due_red_columns[2*BlockWidth-1:0], in_red_columns};
    if (in_row_start) begin
      row_part <= part;
      row_ends_block <= block_ends;
      first_row <= in_frame_start;
      begin_q <= block_ends ? ends - (BlockWidth + 1)'(Numerator) : ends;
      red_rows_q <= red_rows;
      red_come_q <= red_come + (in_blue_row ? '0 : BlockWidth'(Denominator));
      red_until_q <= block_ends ? red_come + (in_blue_row ? '0 : part) : red_until;
    end
    for (int c = 0; c < 3; c++) begin
      if (watched) begin
        come_q[c*TotalWidth+:TotalWidth] <= (fresh_column ? '0 : come_q[c*TotalWidth+:TotalWidth])
            + TotalWidth'(Denominator) * come[c*TotalWidth+:TotalWidth];
        if (ends_now) until_q[c*TotalWidth+:TotalWidth] <= (fresh_column ? '0 : come_q[c*TotalWidth+:TotalWidth])
            + TotalWidth'(part_now) * come[c*TotalWidth+:TotalWidth];
        else if (fresh_column) until_q[c*TotalWidth+:TotalWidth] <= '0;
      end
    end
  end
  if (rst) due <= '0;
end

logic [2*BlockWidth-1:0] red_area, blue_area;
logic [BlockWidth-1:0] rows, columns;
assign rows = due_red_rows[3*BlockWidth-1-:BlockWidth];
assign columns = due_red_columns[3*BlockWidth-1-:BlockWidth];
assign red_area = (2 * BlockWidth)'(rows) * (2 * BlockWidth)'(columns);
assign blue_area = (2 * BlockWidth)'(BlockWidth'(Numerator) - rows) * (2 * BlockWidth)'(BlockWidth'(Numerator) - columns);
always_comb begin
  if (started) begin
    in_time: assert (out_valid == due[2]);
    if (out_valid && due_watched[2]) begin
      if (Totals != 0) summed: assert (out_totals == due_totals[6*TotalWidth+:3*TotalWidth]);
      if (Bayer == 0) area: assert (out_areas == {3{AreaWidth'(Numerator * Numerator)}});
      if (Bayer != 0) begin
        areas: assert (out_areas == {
          blue_area[AreaWidth-1:0], AreaWidth'(Numerator * Numerator) - red_area[AreaWidth-1:0]
          - blue_area[AreaWidth-1:0], red_area[AreaWidth-1:0]
        });
      end
      later_block: cover (!first_row && !in_row_start && 32'(column) == Columns);
    end
  end
end

// Protocol: whole rows of Columns blocks, of any number, from a frame's start on, in a reset too; totals count with
// out_valid.
module protocol_block_totals;
  logic [7:0] column;  // blocks of the row that have ended
  logic in_frame = 1'b0, blue_row = 1'b0, starts_right, stays_right;
  logic [7:0] ended = '0;
  assign column = in_row_start ? '0 : ended;
  assign starts_right = in_row_start ? in_frame_start | (in_frame & ended == 8'(Columns)) : ~in_frame_start;
  assign stays_right = (~in_ends | ((in_frame | in_row_start) & column != 8'(Columns)))
      & (in_row_start | in_blue_row == blue_row);
  assign holds = starts_right & stays_right & 32'(in_red_columns) <= Numerator;
  always_ff @(posedge clk) begin
    if (en) begin
      ended <= column + 8'(in_ends);
      blue_row <= in_blue_row;
    end
    in_frame <= ~reset & (in_frame | (en & in_row_start));
    if (reset) ended <= '0;
  end
  assign counts_out_valid = live & ~reset;
  assign {counts_out_totals, counts_out_areas} = {2{counts_out_valid & out_valid}};
endmodule
