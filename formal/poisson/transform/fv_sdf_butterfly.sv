// SPDX-License-Identifier: Apache-2.0
// fv_sdf_butterfly: of an arbitrary pair a, b of a block the sum leaves at the place of a and the difference at that of
// b, Delay + 2 enabled clocks behind them, turned, halved and saturated as the header says; start, frame_start and the
// count of clipped values with it. Rounding itself is proven of td_round_saturate.

parameter int Width = 2, Size = 8, Delay = 4, RotateBlock = 0, Inverse = 0, Halve = 0;
input logic pick;

localparam int PositionWidth = $clog2(Size), AgeWidth = $clog2(2 * Delay + 3);

logic started, active;
logic [PositionWidth-1:0] position;

// A word as it enters the sum: turned by -j or +j in the last quarter of its block.
logic turned;
logic signed [Width:0] re, im;
assign turned = RotateBlock > 0 && 4 * (32'(position) % (RotateBlock > 0 ? RotateBlock : 1)) >= 3 * RotateBlock;
always_comb begin
  re = (Width + 1)'(in_re);
  im = (Width + 1)'(in_im);
  if (turned) begin
    re = Inverse != 0 ? (Width + 1)'(-(Width + 1)'(in_im)) : (Width + 1)'(in_im);
    im = Inverse != 0 ? (Width + 1)'(in_re) : (Width + 1)'(-(Width + 1)'(in_re));
  end
end

logic following;
logic [AgeWidth-1:0] age;  // enabled clocks since a was present
logic signed [Width:0] a_re, a_im;
logic signed [Width-1:0] sum_re, sum_im, difference_re, difference_im;
logic signed [Width-1:0] sum_re_q, sum_im_q, difference_re_q, difference_im_q;
logic [3:0] clipped;
td_round_saturate #(.InWidth(Width + 2), .Drop(Halve), .OutWidth(Width)) u_sum_re (
  .in((Width + 2)'(a_re) + (Width + 2)'(re)), .out(sum_re), .clipped(clipped[0])
);
td_round_saturate #(.InWidth(Width + 2), .Drop(Halve), .OutWidth(Width)) u_sum_im (
  .in((Width + 2)'(a_im) + (Width + 2)'(im)), .out(sum_im), .clipped(clipped[1])
);
td_round_saturate #(.InWidth(Width + 2), .Drop(Halve), .OutWidth(Width)) u_difference_re (
  .in((Width + 2)'(a_re) - (Width + 2)'(re)), .out(difference_re), .clipped(clipped[2])
);
td_round_saturate #(.InWidth(Width + 2), .Drop(Halve), .OutWidth(Width)) u_difference_im (
  .in((Width + 2)'(a_im) - (Width + 2)'(im)), .out(difference_im), .clipped(clipped[3])
);

logic is_a, was_enabled, held;
assign is_a = active & (32'(position) % (2 * Delay) < Delay);
logic [3:0] clipped_q;
logic [Delay:0] active_q;
kept #(.Width(2 * Width + 2)) u_kept (.clk, .rst, .en, .out({out_start, out_frame_start, out_re, out_im}), .held);
always_ff @(posedge clk) begin
  was_enabled <= en & ~rst;
  if (en) begin
    active_q <= (Delay + 1)'({active_q, active});
    if (!following || age == AgeWidth'(2 * Delay + 2)) begin
      following <= pick & is_a;
      age <= AgeWidth'(1);
      a_re <= re;
      a_im <= im;
    end else begin
      age <= age + AgeWidth'(1);
    end
    if (age == AgeWidth'(Delay)) begin
      sum_re_q <= sum_re;
      sum_im_q <= sum_im;
      difference_re_q <= difference_re;
      difference_im_q <= difference_im;
      clipped_q <= clipped;
    end
  end
  if (rst) begin
    active_q <= '0;
    following <= 1'b0;
  end
end
logic none_leaves;  // nothing was rounded in the clock before
always_ff @(posedge clk) none_leaves <= rst | ~en | ~active_q[Delay];

beat_timing #(.Beats(Size), .Latency(Delay + 2)) u_timing (.*, .beat(position));
always_comb begin
  if (started) begin
    if (following && age == AgeWidth'(Delay + 2)) begin
      sum: assert (out_re == sum_re_q && out_im == sum_im_q);
      if (was_enabled) sum_counted: assert (32'(saturations) == 32'(clipped_q[0]) + 32'(clipped_q[1]));
    end
    if (following && age == AgeWidth'(2 * Delay + 2)) begin
      difference: assert (out_re == difference_re_q && out_im == difference_im_q);
      if (was_enabled) difference_counted: assert (32'(saturations) == 32'(clipped_q[2]) + 32'(clipped_q[3]));
    end
    if (none_leaves) not_counted: assert (saturations == '0);
    // A halved sum stays in range; a difference, or a turned word, need not.
    if (following && (age == AgeWidth'(Delay + 2) || age == AgeWidth'(2 * Delay + 2))) begin
      clips: cover (saturations == 2'd2);
    end
    last_difference: cover (following && age == AgeWidth'(2 * Delay + 2) && out_re == '1 && held);
  end
end
