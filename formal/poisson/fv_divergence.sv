// SPDX-License-Identifier: Apache-2.0
// fv_divergence: f = gx - gx of the pixel to the left + gy - gy of the pixel above, nothing beyond the edge, for every
// pixel of an arbitrary column; valid and frame_start with it, 2 enabled clocks later. Any gaps, any en, frames one
// behind another.
//
// In the first row the line is read before it has been written; that what is read there changes nothing is shown by f
// itself, with a memory of any contents.

parameter int Width = 2, Columns = 4, Neumann = 0;
localparam int ColumnWidth = $clog2(Columns);
input logic [ColumnWidth-1:0] chosen;

wire [ColumnWidth-1:0] column = u_protocol.column;
logic [ColumnWidth-1:0] watched;  // watched: chosen in the first clock, then constant
logic first_row, first_column, last_row, last_column;
assign {last_column, last_row, first_column, first_row} = in_position;

int gx, gy, left, above;
assign gx = Neumann != 0 && last_column ? 0 : 32'(in_gx);
assign gy = Neumann != 0 && last_row ? 0 : 32'(in_gy);
logic signed [Width-1:0] gx_before, gy_before;
assign left = first_column ? 0 : 32'(gx_before);
assign above = first_row ? 0 : 32'(gy_before);
logic signed [OutWidth-1:0] f, f_q, f_q2;
assign f = OutWidth'(gx - left + gy - above);

logic [1:0] valid, frame_start, of_column;
logic held;
kept #(.Width(OutWidth + 2)) u_kept (.clk, .rst, .en, .out({out_valid, out_frame_start, out_data}), .held);
always_ff @(posedge clk) begin
  if (!started) watched <= chosen;
  if (en) begin
    if (in_valid) begin
      gx_before <= Width'(gx);
      if (column == watched) gy_before <= Width'(gy);
    end
    valid <= {valid[0], in_valid};
    frame_start <= {frame_start[0], in_valid & first_row & first_column};
    of_column <= {of_column[0], in_valid & (column == watched)};
    f_q <= f;
    f_q2 <= f_q;
  end
  if (rst) begin
    valid <= '0;
    frame_start <= '0;
    of_column <= '0;
  end
end

always_comb begin
  if (started) begin
    valid_when_due: assert (out_valid == valid[1]);
    frame_start_when_due: assert (out_frame_start == frame_start[1]);
    if (of_column[1]) difference: assert (out_data == f_q2);
    largest: cover (of_column[1] && f_q2 == (Neumann != 0 ? OutWidth'(4) : OutWidth'(6)) && last_row);
    first_of_second_frame: cover (of_column[1] && out_frame_start && held && first_row && watched == '0);
  end
end

bind dut.u_line ram_check #(.Depth(Depth), .Defined(0)) u_check (.*);

// Protocol: pixels in raster order, in a reset too; how many rows a frame has is left open.
module protocol_divergence;
  localparam int ColumnWidth = $clog2(Columns);
  logic [ColumnWidth-1:0] column;
  logic first_row = 1'b1, last_row_before, marks_right;
  logic in_first_row, in_first_column, in_last_row, in_last_column;
  assign {in_last_column, in_last_row, in_first_column, in_first_row} = in_position;
  assign marks_right = (in_first_column == (column == '0)) & (in_last_column == (column == ColumnWidth'(Columns - 1)))
      & (in_first_row == first_row) & (column == '0 | in_last_row == last_row_before);
  assign holds = ~in_valid | marks_right;
  always_ff @(posedge clk) begin
    if (reset) begin
      column <= '0;
      first_row <= 1'b1;
    end else if (en && in_valid) begin
      column <= in_last_column ? '0 : column + ColumnWidth'(1);
      if (in_last_column) first_row <= in_last_row;
      last_row_before <= in_last_row;
    end
  end
  assign {counts_out_valid, counts_out_frame_start} = {2{live & ~reset & en}};
  assign counts_out_data = counts_out_valid & out_valid;
endmodule
