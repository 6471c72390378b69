// SPDX-License-Identifier: Apache-2.0
// fv_row_sums: a word with the last pixel of each block, 3 enabled clocks later, with the sums of each lane over it.
//
// The specification adds up whole pixels from the beginning of the row and takes the difference of what it has at the
// ends of two blocks, modulo the width of a sum; the core sums block by block.

parameter int Numerator = 5, Denominator = 2, Width = 1, Bayer = 1;

localparam int Lanes = Bayer != 0 ? 2 : 3;

// Where the pixel ends, from the beginning of its block; its part in the block.
logic [BlockWidth:0] begin_q, begins, ends;
logic block_ends;
logic [BlockWidth-1:0] part;
assign begins = in_row_start ? '0 : begin_q;
assign ends = begins + (BlockWidth + 1)'(Denominator);
assign block_ends = ends >= (BlockWidth + 1)'(Numerator);
assign part = block_ends ? BlockWidth'(Numerator) - BlockWidth'(begins) : BlockWidth'(Denominator);

// What has come of each lane since the row began, and what had come when the last block ended.
logic [Lanes*SumWidth-1:0] come_q, until_q, sums;
logic [BlockWidth-1:0] red_come_q, red_until_q, red;
always_comb begin
  for (int l = 0; l < Lanes; l++) begin
    logic [SumWidth-1:0] sample, come, until_block;
    sample = SumWidth'($signed(in_samples[(Bayer != 0 ? 0 : l)*Width+:Width]));
    if (Bayer != 0 && in_blue_column != (l != 0)) sample = '0;
    come = in_row_start ? '0 : come_q[l*SumWidth+:SumWidth];
    until_block = in_row_start ? '0 : until_q[l*SumWidth+:SumWidth];
    sums[l*SumWidth+:SumWidth] = SumWidth'(come + SumWidth'(part) * sample) - until_block;
  end
  red = (in_row_start ? '0 : red_come_q) + (in_blue_column ? '0 : part) - (in_row_start ? '0 : red_until_q);
end

logic [2:0] due;
logic [3*Lanes*SumWidth-1:0] due_sums;
logic [3*BlockWidth-1:0] due_red;
always_ff @(posedge clk) begin
  if (en) begin
    due <= {due[1:0], in_valid & block_ends};
    due_sums <= {due_sums[2*Lanes*SumWidth-1:0], sums};
    due_red <= {due_red[2*BlockWidth-1:0], red};
    if (in_valid) begin
      begin_q <= block_ends ? ends - (BlockWidth + 1)'(Numerator) : ends;
      red_come_q <= (in_row_start ? '0 : red_come_q) + (in_blue_column ? '0 : BlockWidth'(Denominator));
      if (block_ends) red_until_q <= (in_row_start ? '0 : red_come_q) + (in_blue_column ? '0 : part);
      else if (in_row_start) red_until_q <= '0;
      for (int l = 0; l < Lanes; l++) begin
        logic [SumWidth-1:0] sample, come;
        sample = SumWidth'($signed(in_samples[(Bayer != 0 ? 0 : l)*Width+:Width]));
        if (Bayer != 0 && in_blue_column != (l != 0)) sample = '0;
        come = in_row_start ? '0 : come_q[l*SumWidth+:SumWidth];
        come_q[l*SumWidth+:SumWidth] <= come + SumWidth'(Denominator) * sample;
        if (block_ends) until_q[l*SumWidth+:SumWidth] <= come + SumWidth'(part) * sample;
        else if (in_row_start) until_q[l*SumWidth+:SumWidth] <= '0;
      end
    end
  end
  if (rst) due <= '0;
end

always_comb begin
  if (started) begin
    in_time: assert (out_ends == due[2]);
    if (out_ends) begin
      summed: assert (out_sums == due_sums[2*Lanes*SumWidth+:Lanes*SumWidth]);
      if (Bayer != 0) red_width: assert (out_red_columns == due_red[2*BlockWidth+:BlockWidth]);
      another_row_begins: cover (out_sums != '0 && in_row_start && in_valid);
    end
    ends_in_a_gap: cover (out_ends && !in_valid && en && due[1:0] == '0);
  end
end
