// SPDX-License-Identifier: Apache-2.0
// channel_gain: black level and gain of each colour.
//
//   out = (sample - black_level) gain / 2^12, rounded half to even, saturated to Bits + 2 signed bits
//
// 2^Bits is full scale. Nothing is clipped at black or at white: what is averaged later is clipped there. With
// black_level 0 and gains of 2^12 out is the sample. The settings of a frame are those with its first pixel.
// Stream in, stream out: the pixels of the window with their marks; of a Bayer pattern in_colour says which gain holds.
// Latency: 3 cycles with en, in_abort too; en low: nothing moves.
// Bit-accurate model: models/tactile_depth/camera/channel_gain.py.

`default_nettype none

module channel_gain #(
  parameter int Bits  = 10,
  parameter int Bayer = 1,
  localparam int Channels = Bayer != 0 ? 1 : 3,
  localparam int Width = Bits + 2
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire  [Bits-1:0]           black_level,
  input  wire  [15:0]               red_gain,  // 4 bits before the point, 12 behind it
  input  wire  [15:0]               green_gain,
  input  wire  [15:0]               blue_gain,
  input  wire                       in_valid,
  input  wire  [Channels*Width-1:0] in_samples,  // signed, red lowest
  input  wire  [1:0]                in_colour,   // Bayer: bit 0 a column of blue, bit 1 a row of blue
  input  wire                       in_row_start,
  input  wire                       in_frame_start,
  input  wire                       in_abort,
  output logic                      out_valid,
  output logic [Channels*Width-1:0] out_samples,
  output logic [1:0]                out_colour,
  output logic                      out_row_start,
  output logic                      out_frame_start,
  output logic                      out_abort
);

  localparam int GainWidth = 16;
  localparam int GainFraction = 12;
  localparam int Product = Width + 1 + GainWidth + 1;

  // Settings of this frame.
  logic starts;
  logic [Bits-1:0] black, black_q;
  logic [3*GainWidth-1:0] gains, gains_q;  // red lowest
  assign starts = in_valid & in_frame_start;
  assign black = starts ? black_level : black_q;
  assign gains = starts ? {blue_gain, green_gain, red_gain} : gains_q;

  logic [2:0] valid, abort;
  logic [11:0] marks;
  assign {out_valid, out_abort} = {valid[2], abort[2]};
  assign {out_colour, out_row_start, out_frame_start} = marks[11:8];
  always_ff @(posedge clk) begin
    if (en) begin
      black_q <= black;
      gains_q <= gains;
      valid <= {valid[1:0], in_valid};
      abort <= {abort[1:0], in_abort};
      marks <= {marks[7:0], in_colour, in_row_start, in_frame_start};
    end
    if (rst) begin
      valid <= '0;
      abort <= '0;
    end
  end

  for (genvar c = 0; c < Channels; c++) begin : g_channel
    logic signed [Width-1:0] sample, rounded;
    logic signed [Width:0] difference;
    logic signed [Product-1:0] product;
    logic [GainWidth-1:0] gain, gain_q;
    logic unused_clipped;
    assign sample = in_samples[c*Width+:Width];
    if (Bayer != 0) begin : g_bayer
      assign gain = in_colour == 2'd0 ? gains[0+:GainWidth]
          : in_colour == 2'd3 ? gains[2*GainWidth+:GainWidth] : gains[GainWidth+:GainWidth];
    end else begin : g_rgb
      assign gain = gains[c*GainWidth+:GainWidth];
    end
    always_ff @(posedge clk) begin
      if (en) begin
        difference <= (Width + 1)'(sample) - (Width + 1)'({1'b0, black});
        gain_q <= gain;
        out_samples[c*Width+:Width] <= rounded;
      end
    end
    td_multiply #(.AWidth(Width + 1), .BWidth(GainWidth + 1)) u_gain (
      .clk, .en, .a(difference), .b({1'b0, gain_q}), .product(product)
    );
    td_round_saturate #(.InWidth(Product), .Drop(GainFraction), .OutWidth(Width)) u_round (
      .in(product), .out(rounded), .clipped(unused_clipped)
    );
  end

endmodule

`default_nettype wire
