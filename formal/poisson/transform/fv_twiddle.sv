// SPDX-License-Identifier: Apache-2.0
// fv_twiddle: 5 enabled clocks behind an arbitrary beat the product of each of its words with the factor of its
// path and beat in the ROM stands in its path, rounded and saturated; start, frame_start and the clip count of the beat
// with it. A path of Ones has the same product as with multipliers. Rounding is proven of td_round_saturate.

parameter int Paths = 2, Beats = 2, Block = 2, RealOnly = 0, Ones = 0;
localparam int Width = 3, CoeffWidth = 3, InWidth = Width, OutWidth = Width, Drop = CoeffWidth - 1;
localparam logic [Paths-1:0] Ones = Ones[Paths-1:0];
localparam File = "factors.hex";

localparam int BeatWidth = $clog2(Beats), Latency = 5, SumWidth = Width + CoeffWidth + 1;

logic started, active;
logic [BeatWidth-1:0] beat;
beat_timing #(.Beats(Beats), .Latency(Latency)) u_timing (.*);

logic [3*CoeffWidth*Paths-1:0] factors[Block];
initial $readmemh("factors.hex", factors);
logic [3*CoeffWidth*Paths-1:0] word;
assign word = factors[32'(beat)%Block];

logic [Paths*Width-1:0] re, im;  // expected
logic [2*Paths-1:0] clipped;
for (genvar path = 0; path < Paths; path++) begin : g_path
  logic signed [CoeffWidth-1:0] w_re, w_im, w_minus_im;
  logic signed [SumWidth-1:0] a, b, sum_re, sum_im;
  assign {w_minus_im, w_im, w_re} = word[path*3*CoeffWidth+:3*CoeffWidth];
  assign a = SumWidth'($signed(in_re[path*Width+:Width]));
  assign b = SumWidth'($signed(in_im[path*Width+:Width]));
  assign sum_re = a * w_re + b * w_minus_im;
  if (RealOnly != 0) begin : g_real
    assign sum_im = '0;
  end else begin : g_complex
    assign sum_im = a * w_im + b * w_re;
  end
  td_round_saturate #(.InWidth(SumWidth), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_re (
    .in(sum_re), .out(re[path*Width+:Width]), .clipped(clipped[2*path])
  );
  td_round_saturate #(.InWidth(SumWidth), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_im (
    .in(sum_im), .out(im[path*Width+:Width]), .clipped(clipped[2*path+1])
  );
end

logic held;
logic [Latency-1:0] active_q;
logic [Latency-1:0][2*Paths*Width-1:0] words_q;
logic [Latency-2:0][CountWidth-1:0] clipped_q;
logic [1:0][CountWidth-1:0] count_q;
kept #(.Width(2 * Paths * Width + 2)) u_kept (
  .clk, .rst, .en, .out({out_start, out_frame_start, out_re, out_im}), .held
);
always_ff @(posedge clk) begin
  if (en) begin
    active_q <= {active_q[Latency-2:0], active};
    words_q <= {words_q[Latency-2:0], re, im};
    clipped_q <= {clipped_q[Latency-3:0], CountWidth'($countones(clipped))};
  end
  count_q <= {count_q[0], en && active_q[Latency-2] ? clipped_q[Latency-2] : CountWidth'(0)};
  if (rst) begin
    active_q <= '0;
    count_q <= '0;
  end
end
always_comb begin
  if (started) begin
    if (active_q[Latency-1]) products: assert ({out_re, out_im} == words_q[Latency-1]);
    counted: assert (saturations == count_q[1]);
    clips: cover (saturations != '0 && held);
    largest: cover (active_q[Latency-1] && out_re[Paths*Width-1-:Width] == Width'(3));
  end
end
