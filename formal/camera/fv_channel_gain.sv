// SPDX-License-Identifier: Apache-2.0
// fv_channel_gain: out is the sample less the black level times its gain, with the settings that stood beside the frame's
// first pixel; pixels, marks and breaks leave 3 enabled clocks later.
//
// Gains are whole numbers here: rounding is proven of td_round_saturate. Samples are small, so that nothing saturates.

`default_nettype none

module fv_channel_gain #(
  parameter int Bayer = 1,
  localparam int Bits = 4,
  localparam int Width = Bits + 2,
  localparam int Channels = Bayer != 0 ? 1 : 3
) (
  input logic                      clk,
  input logic                      rst,
  input logic                      en,
  input logic [Bits-1:0]           black_level,
  input logic [15:0]               red_gain,
  input logic [15:0]               green_gain,
  input logic [15:0]               blue_gain,
  input logic                      in_valid,
  input logic [Channels*Width-1:0] in_samples,
  input logic [1:0]                in_colour,
  input logic                      in_row_start,
  input logic                      in_frame_start,
  input logic                      in_abort
);

  localparam int Latency = 3;
  localparam int Fraction = 12;
  logic out_valid, out_row_start, out_frame_start, out_abort;
  logic [1:0] out_colour;
  logic [Channels*Width-1:0] out_samples;
  channel_gain #(.Bits(Bits), .Bayer(Bayer)) dut (
    .clk, .rst, .en, .black_level, .red_gain, .green_gain, .blue_gain, .in_valid, .in_samples, .in_colour,
    .in_row_start, .in_frame_start, .in_abort, .out_valid, .out_samples, .out_colour, .out_row_start, .out_frame_start,
    .out_abort
  );

  logic started = 1'b0;
  logic in_frame;
  logic [Bits-1:0] black_q, black;
  logic [2:0] gains_q, gains, given;  // one bit each: 0 or 1; red lowest
  always_comb begin
    if (!started) assume (rst);
    if (in_valid && !in_frame) assume (in_frame_start);
    assume (({red_gain, green_gain, blue_gain} & ~{3{16'h1000}}) == '0);
    for (int c = 0; c < Channels; c++) assume (in_samples[c*Width+Bits+:2] == '0);
  end
  assign given = {blue_gain[Fraction], green_gain[Fraction], red_gain[Fraction]};
  assign black = in_valid && in_frame_start ? black_level : black_q;
  assign gains = in_valid && in_frame_start ? given : gains_q;

  logic [Channels*Width-1:0] scaled;
  always_comb begin
    for (int c = 0; c < Channels; c++) begin
      logic gain;
      gain = gains[c];
      if (Bayer != 0) gain = in_colour == 2'd0 ? gains[0] : in_colour == 2'd3 ? gains[2] : gains[1];
      scaled[c*Width+:Width] = gain ? in_samples[c*Width+:Width] - Width'(black) : '0;
    end
  end

  logic [Latency-1:0] valid, abort;
  logic [4*Latency-1:0] marks;
  logic [Latency*Channels*Width-1:0] samples;
  logic held;
  logic [Channels*Width+5:0] out_q;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    held <= started & ~en & ~rst;
    out_q <= {out_valid, out_abort, out_colour, out_row_start, out_frame_start, out_samples};
    if (en) begin
      black_q <= black;
      gains_q <= gains;
      if (in_valid) in_frame <= 1'b1;
      valid <= {valid[Latency-2:0], in_valid};
      abort <= {abort[Latency-2:0], in_abort};
      marks <= {marks[4*Latency-5:0], in_colour, in_row_start, in_frame_start};
      samples <= {samples[(Latency-1)*Channels*Width-1:0], scaled};
    end
    if (rst) begin
      valid <= '0;
      abort <= '0;
      in_frame <= 1'b0;
    end
  end

  always_comb begin
    if (started) begin
      in_time: assert (out_valid == valid[Latency-1] && out_abort == abort[Latency-1]);
      if (out_valid) begin
        marked: assert ({out_colour, out_row_start, out_frame_start} == marks[4*Latency-1-:4]);
        product: assert (out_samples == samples[Latency*Channels*Width-1-:Channels*Width]);
        old_settings: cover (out_samples != '0 && !out_frame_start && given == '0 && valid[1:0] == '0);
        below_black: cover (out_samples[Width-1] && out_colour == 2'd3);
      end
      if (held) holds: assert (out_q == {out_valid, out_abort, out_colour, out_row_start, out_frame_start, out_samples});
    end
  end

endmodule

`default_nettype wire
