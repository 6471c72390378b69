// SPDX-License-Identifier: Apache-2.0
// fv_butterfly: 2 enabled clocks behind an arbitrary pair a, b of a beat its sum stands in the path of a and its
// difference in that of b, rotated, halved and saturated as the header says; start, frame_start and the count of
// clipped values of the beat with it. Rounding itself is proven of td_round_saturate.

parameter int Width = 2, Paths = 4, Beats = 2, PathBit = 0, RotateBit = -1, Inverse = 0, Halve = 0;

localparam int PathWidth = $clog2(Paths), BeatWidth = $clog2(Beats);

logic started, active;
logic [BeatWidth-1:0] beat;
beat_timing #(.Beats(Beats), .Latency(2)) u_timing (.*);

logic [Paths*Width-1:0] re, im;  // expected
logic [2*Paths-1:0] clipped;
for (genvar path = 0; path < Paths; path++) begin : g_path
  localparam int A = path & ~(1 << PathBit), B = path | (1 << PathBit);
  logic signed [Width-1:0] a_re, a_im, b_re, b_im;
  logic signed [Width+1:0] turned_re, turned_im, sum_re, sum_im;
  logic rotate;
  assign {a_re, a_im} = {in_re[A*Width+:Width], in_im[A*Width+:Width]};
  assign {b_re, b_im} = {in_re[B*Width+:Width], in_im[B*Width+:Width]};
  assign rotate = RotateBit >= 0 && ((32'(beat) << PathWidth) | A) >> (RotateBit >= 0 ? RotateBit : 0) & 1;
  always_comb begin
    turned_re = (Width + 2)'(b_re);
    turned_im = (Width + 2)'(b_im);
    if (rotate) begin
      turned_re = Inverse != 0 ? -(Width + 2)'(b_im) : (Width + 2)'(b_im);
      turned_im = Inverse != 0 ? (Width + 2)'(b_re) : -(Width + 2)'(b_re);
    end
    sum_re = path == A ? (Width + 2)'(a_re) + turned_re : (Width + 2)'(a_re) - turned_re;
    sum_im = path == A ? (Width + 2)'(a_im) + turned_im : (Width + 2)'(a_im) - turned_im;
  end
  td_round_saturate #(.InWidth(Width + 2), .Drop(Halve), .OutWidth(Width)) u_re (
    .in(sum_re), .out(re[path*Width+:Width]), .clipped(clipped[2*path])
  );
  td_round_saturate #(.InWidth(Width + 2), .Drop(Halve), .OutWidth(Width)) u_im (
    .in(sum_im), .out(im[path*Width+:Width]), .clipped(clipped[2*path+1])
  );
end

// The count follows the clock in which the words are rounded, which counts only with en.
logic [1:0] active_q;
logic [1:0][2*Paths*Width-1:0] words_q;
logic [2*Paths-1:0] clipped_q;
logic [1:0][CountWidth-1:0] count_q;
logic held;
kept #(.Width(2 * Paths * Width + 2)) u_kept (
  .clk, .rst, .en, .out({out_start, out_frame_start, out_re, out_im}), .held
);
always_ff @(posedge clk) begin
  if (en) begin
    active_q <= {active_q[0], active};
    words_q <= {words_q[0], re, im};
    clipped_q <= clipped;
  end
  count_q <= {count_q[0], en && active_q[0] ? CountWidth'($countones(clipped_q)) : CountWidth'(0)};
  if (rst) begin
    active_q <= '0;
    count_q <= '0;
  end
end
always_comb begin
  if (started) begin
    if (active_q[1]) results: assert ({out_re, out_im} == words_q[1]);
    counted: assert (saturations == count_q[1]);
    clips: cover (saturations != '0 && held);
    last: cover (active_q[1] && out_re == '1 && out_im == '0);
  end
end
