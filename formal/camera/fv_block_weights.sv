// SPDX-License-Identifier: Apache-2.0
// fv_block_weights: the weight of a pixel is its overlap with the block that it is in or begins in.
//
// The specification counts how far the axis has come, modulo the length of a block; the core counts what is left of it.

parameter int Numerator = 15, Denominator = 4;

logic [15:0] begin_q, begins, ends;  // of the pixel, from the beginning of a block
logic known = 1'b0;                  // an axis has begun
assign begins = restart ? 16'd0 : begin_q;
assign ends = begins + 16'(Denominator);
always_ff @(posedge clk) begin
  if (en && step) begin
    known <= known | restart;
    begin_q <= ends >= 16'(Numerator) ? ends - 16'(Numerator) : ends;
  end
end

always_comb begin
  if (known || restart) begin
    last: assert (block_ends == (ends >= 16'(Numerator)));
    overlap: assert (16'(weight) == (block_ends ? 16'(Numerator) - begins : 16'(Denominator)));
    whole_at_the_end: cover (block_ends && 32'(weight) == Denominator);
    split: cover ((Numerator % Denominator == 0) || (block_ends && 32'(weight) < Denominator && !restart));
  end
end
