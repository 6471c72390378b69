// SPDX-License-Identifier: Apache-2.0
// black_level: samples less the black level, beside the gains of their frame.
//
//   out = sample - black_level
//
// The black level and the gains of a frame are those that stand here with its first pixel. A sample of pixel_format
// lies so far within Bits + 2 bits that no difference leaves them, and nothing is clipped before the average. Stream
// in, stream out: the pixels of the window with their marks. out_gains belong to the pixel on out_samples. Latency: 1
// cycle with en, in_abort too; en low: nothing moves.
// Bit-accurate model: models/tactile_depth/chip/camera/black_level.py.

`default_nettype none

module black_level #(
  parameter int Bits       = 10,
  parameter int Channels   = 1,
  parameter int GainsWidth = 48,
  localparam int Width = Bits + 2
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire  [Bits-1:0]           level,
  input  wire  [GainsWidth-1:0]     gains,
  input  wire                       in_valid,
  input  wire  [Channels*Width-1:0] in_samples,  // signed
  input  wire  [1:0]                in_colour,
  input  wire                       in_row_start,
  input  wire                       in_frame_start,
  input  wire                       in_abort,
  output logic                      out_valid,
  output logic [Channels*Width-1:0] out_samples,
  output logic [1:0]                out_colour,
  output logic                      out_row_start,
  output logic                      out_frame_start,
  output logic                      out_abort,
  output logic [GainsWidth-1:0]     out_gains
);

  logic starts;
  logic [Bits-1:0] frame_level, frame_level_q;
  assign starts = in_valid & in_frame_start;
  assign frame_level = starts ? level : frame_level_q;

  always_ff @(posedge clk) begin
    if (en) begin
      frame_level_q <= frame_level;
      if (starts) out_gains <= gains;
      out_valid <= in_valid;
      out_abort <= in_abort;
      out_colour <= in_colour;
      out_row_start <= in_row_start;
      out_frame_start <= in_frame_start;
      for (int c = 0; c < Channels; c++)
        out_samples[c*Width+:Width] <= in_samples[c*Width+:Width] - Width'(frame_level);
    end
    if (rst) begin
      out_valid <= 1'b0;
      out_abort <= 1'b0;
    end
  end

endmodule

`default_nettype wire
