// SPDX-License-Identifier: Apache-2.0
// fv_wide_twiddle: an arbitrary word of an arbitrary path meets the factor of its path and beat in the ROM and leaves 5
// enabled clocks later; start and frame_start likewise. The words are 1 or j, so that what leaves is the factor itself,
// and every field of it is seen; the exact product is proven of td_dot_product, rounding of td_round_saturate.

`default_nettype none

module fv_wide_twiddle #(
  parameter int Paths    = 2,
  parameter int Beats    = 4,
  parameter int RealOnly = 0,
  parameter int Ones     = 0,
  localparam int PathWidth = $clog2(Paths),
  localparam int BeatWidth = $clog2(Beats)
) (
  input logic                 clk,
  input logic                 rst,
  input logic                 en,
  input logic                 in_start,
  input logic                 in_frame_start,
  input logic [Paths-1:0]     turned,
  input logic                 pick,
  input logic [PathWidth-1:0] chosen
);

  localparam int Latency = 5;
  localparam int CoeffWidth = 5;
  localparam int OutWidth = 8;

  logic out_start, out_frame_start, started, active;
  logic [Paths*OutWidth-1:0] out_re, out_im;
  logic [BeatWidth-1:0] beat;
  logic [$clog2(2*Paths+1)-1:0] saturations;
  logic [2*Paths-1:0] in_re, in_im;
  for (genvar path = 0; path < Paths; path++) begin : g_word
    assign in_re[2*path+:2] = turned[path] ? 2'd0 : 2'd1;
    assign in_im[2*path+:2] = turned[path] ? 2'd1 : 2'd0;
  end
  wide_twiddle #(
    .InWidth(2), .OutWidth(OutWidth), .CoeffWidth(CoeffWidth), .Drop(0), .Paths(Paths), .Beats(Beats),
    .RealOnly(RealOnly), .Ones(Ones[Paths-1:0]), .File("factors.hex")
  ) dut (.*);
  wide_timing #(.Beats(Beats), .Latency(Latency)) u_timing (.*);

  logic [3*CoeffWidth*Paths-1:0] factors[Beats];
  initial $readmemh("factors.hex", factors);
  logic [3*CoeffWidth*Paths-1:0] word;
  logic signed [CoeffWidth-1:0] w_re, w_im, w_minus_im;
  assign word = factors[beat];
  assign {w_minus_im, w_im, w_re} = word[chosen*3*CoeffWidth+:3*CoeffWidth];

  logic due, held;
  logic [PathWidth-1:0] path;
  logic signed [OutWidth-1:0] re, im, factor_re, factor_im;
  assign factor_re = turned[chosen] ? OutWidth'(w_minus_im) : OutWidth'(w_re);
  assign factor_im = RealOnly != 0 ? '0 : turned[chosen] ? OutWidth'(w_re) : OutWidth'(w_im);
  follow_delay #(.Width(2 * OutWidth + PathWidth), .Latency(Latency)) u_follow (
    .clk, .rst, .en, .pick(pick & active), .in({chosen, factor_re, factor_im}), .due, .word({path, re, im})
  );
  kept #(.Width(2 * OutWidth * Paths + 2)) u_kept (
    .clk, .rst, .en, .out({out_start, out_frame_start, out_re, out_im}), .held
  );
  always_comb begin
    if (started) begin
      if (due) own_factor: assert (out_re[path*OutWidth+:OutWidth] == re && out_im[path*OutWidth+:OutWidth] == im);
      none_clipped: assert (saturations == '0);
      last_path: cover (due && held && path == PathWidth'(Paths - 1) && re != '0);
    end
  end

endmodule

`default_nettype wire
