// SPDX-License-Identifier: Apache-2.0
// fv_twiddle_multiply: an arbitrary word meets the ROM word of its own position modulo Block and leaves 7 enabled
// clocks later; start and frame_start likewise. The words are 1 or j, so that what leaves is the factor itself, and
// every field of it is seen; the exact product is proven of td_dot_product, rounding of td_round_saturate.

parameter int Size = 8, Block = 4, RealOnly = 0;
localparam int CoeffWidth = 5, OutWidth = 8, InWidth = 2, Drop = 0;
localparam File = "factors.hex";
input logic turned, pick;

localparam int PositionWidth = $clog2(Size), Latency = 7;

assign in_re = turned ? 2'd0 : 2'd1;
assign in_im = turned ? 2'd1 : 2'd0;
logic started, active;
logic [PositionWidth-1:0] position;

logic [3*CoeffWidth-1:0] factors[Block];
initial $readmemh("factors.hex", factors);
logic signed [CoeffWidth-1:0] w_re, w_im, w_minus_im;
assign {w_minus_im, w_im, w_re} = factors[32'(position) % Block];

logic due, held;
logic signed [OutWidth-1:0] re, im, factor_re, factor_im;
assign factor_re = turned ? OutWidth'(w_minus_im) : OutWidth'(w_re);
assign factor_im = RealOnly != 0 ? '0 : turned ? OutWidth'(w_re) : OutWidth'(w_im);
follow_delay #(.Width(2 * OutWidth), .Latency(Latency)) u_follow (
  .clk, .rst, .en, .pick(pick & active), .in({factor_re, factor_im}), .due, .word({re, im})
);
kept #(.Width(2 * OutWidth + 2)) u_kept (.clk, .rst, .en, .out({out_start, out_frame_start, out_re, out_im}), .held);
burst_timing #(.Columns(Size), .Latency(Latency)) u_timing (.*, .row());
always_comb begin
  if (started) begin
    if (due) own_factor: assert (out_re == re && out_im == im);
    none_clipped: assert (saturations == '0);
    last_word: cover (due && held
        && re == OutWidth'($signed(factors[Block-1][CoeffWidth-1:0])));
  end
end
