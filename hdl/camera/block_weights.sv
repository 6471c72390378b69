// SPDX-License-Identifier: Apache-2.0
// block_weights: cuts an axis of camera pixels into blocks of Numerator / Denominator pixels.
//
// A block is one row or one column of the grid. Lengths are in units of 1 / Denominator of a camera pixel, so a pixel
// is Denominator long and a block Numerator. `weight` is the part of the present pixel in the present block. When
// `block_ends`, the pixel is the last of the block, and its other part, Denominator - weight, is in the next block.
// `step` takes the present pixel; with `restart` it is the first of the axis. The outputs are combinational and belong
// to the present pixel. en low: nothing moves. Bit-accurate model: models/tactile_depth/chip/camera/block_weights.py.

`default_nettype none

module block_weights #(
  parameter int Numerator   = 15,
  parameter int Denominator = 4,
  localparam int Width = $clog2(Denominator + 1)
) (
  input  wire              clk,
  input  wire              en,
  input  wire              step,
  input  wire              restart,
  output logic [Width-1:0] weight,
  output logic             block_ends
);

  localparam int LeftWidth = $clog2(Numerator + 1);
  localparam logic [LeftWidth-1:0] Block = LeftWidth'(Numerator);
  localparam logic [LeftWidth-1:0] Pixel = LeftWidth'(Denominator);

  logic [LeftWidth-1:0] left, left_now;  // of the present block, that no pixel before this one covers
  assign left_now = restart ? Block : left;
  assign block_ends = {1'b0, left_now} <= {1'b0, Pixel};  // at a ratio of 1 Pixel is the largest of LeftWidth bits
  assign weight = block_ends ? Width'(left_now) : Width'(Pixel);

  always_ff @(posedge clk) begin
    if (en && step) left <= block_ends ? Block - (Pixel - left_now) : left_now - Pixel;
  end

endmodule

`default_nettype wire
