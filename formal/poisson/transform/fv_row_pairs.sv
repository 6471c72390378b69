// SPDX-License-Identifier: Apache-2.0
// fv_row_pairs: the word at an arbitrary position p of an arbitrary burst is sat(a[N-k] - b[k]) + j sat(a[k] + b[N-k])
// of the same burst, k = p with its bits reversed; mode 0 has no partner. Latency Beats / 2 + 3. Rounding is proven of
// td_round_saturate.

parameter int Width = 2, Size = 8, Paths = 2;
input logic pick;  // free: the burst that begins is followed
input logic [$clog2(Size)-1:0] chosen;

localparam int PositionWidth = $clog2(Size);
localparam int Beats = Size / Paths;  // of a burst
localparam int BeatWidth = $clog2(Beats), Latency = Beats / 2 + 3;

logic started, active;
logic [BeatWidth-1:0] beat;
beat_timing #(.Beats(Beats), .Latency(Latency)) u_timing (.*);

// The place followed, chosen in the first clock, then constant, and that of mode N - k.
function automatic logic [PositionWidth-1:0] reversed(input logic [PositionWidth-1:0] word);
  for (int b = 0; b < PositionWidth; b++) reversed[b] = word[PositionWidth-1-b];
endfunction
logic [PositionWidth-1:0] position, mirror;
logic [31:0] path, mirror_path;
assign mirror = reversed(PositionWidth'(Size - 32'(reversed(position))));
assign path = 32'(position) % Paths;
assign mirror_path = 32'(mirror) % Paths;

// The burst followed: its modes, then what leaves.
logic following, coming;
logic [7:0] age;  // enabled clocks since its start
logic signed [Width-1:0] a, b, a_mirror, b_mirror, re, im;
logic signed [Width:0] sum_re, sum_im;
assign coming = following & (age >= 8'd2) & (age < 8'(2 + Beats));
always_ff @(posedge clk) begin
  if (!started) position <= chosen;
  if (en) begin
    if (following) age <= age + 8'd1;
    if (!following || age == 8'(Latency + 1 + Beats)) begin
      following <= pick & in_start;
      age <= 8'd1;
    end
    if (coming && 32'(beat) == 32'(position) / Paths) {a, b} <= {in_a[path*Width+:Width], in_b[path*Width+:Width]};
    if (coming && 32'(beat) == 32'(mirror) / Paths)
      {a_mirror, b_mirror} <= {in_a[mirror_path*Width+:Width], in_b[mirror_path*Width+:Width]};
  end
  if (rst) following <= 1'b0;
end
assign sum_re = (position == '0 ? '0 : (Width + 1)'(a_mirror)) - (Width + 1)'(b);
assign sum_im = (Width + 1)'(a) + (position == '0 ? '0 : (Width + 1)'(b_mirror));
td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_re (.in(sum_re), .out(re), .clipped());
td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_im (.in(sum_im), .out(im), .clipped());

always_comb begin
  if (started && following && 32'(age) == Latency + 2 + 32'(position) / Paths) begin
    real_part: assert (out_re[path*Width+:Width] == re);
    imaginary_part: assert (out_im[path*Width+:Width] == im);
    partner: cover (position != mirror && re == '1 && im == '1 && en);
  end
end

// What makes the proof end.
// Steps of the proof: of each burst on its way, by the clocks since its start, where the writer and the reader of the
// core are; that the modes followed stand in their memories until they meet. All together follow from themselves in one
// clock, so induction ends.
if (1) begin : g_steps
  localparam int Reads = Beats / 2 + 1, Delay = Reads + 1, Longest = Reads + Beats + 3;
  wire [BeatWidth:0] left = u_timing.u_timing.u_protocol.left;  // beats of the burst that are to come

  function automatic logic [Longest-1:0] from_to(input int from, input int to);  // bits from .. to - 1
    from_to = '0;
    for (int n = 0; n < Longest; n++) from_to[n] = n >= from && n < to;
  endfunction

  logic [Longest-1:0] starts;  // starts[n]: a burst began n + 1 enabled clocks ago
  always_ff @(posedge clk) begin
    if (en) starts <= {starts[Longest-2:0], in_start};
    if (rst) starts <= '0;
  end
  always_comb begin
    if (started) begin
      burst: assert (dut.u_write.running == (left != '0) && (left != '0) == ((starts & from_to(0, Beats - 1)) != '0));
      reads: assert (dut.read_active == ((starts & from_to(Reads, Reads + Beats)) != '0));
      alike: assert (u_timing.u_timing.start_q == starts[Latency-1:0]
          && (u_timing.u_timing.frame_start_q & ~starts[Latency-1:0]) == '0);
      for (int i = 0; i < 2; i++) assert (dut.active_q[i] == ((starts & from_to(i, i + Beats)) != '0)
          && u_timing.active_q[i] == dut.active_q[i]);
      if (following) in_time: assert (age != '0 && 32'(age) <= Longest && starts[age-1]);
    end
  end
  for (genvar n = 0; n < Longest; n++) begin : g_age
    always_comb begin
      if (started && starts[n]) begin
        apart: assert ((starts & from_to(n + 1, n + Beats)) == '0);
        if (n < Beats - 1) writes: assert (32'(dut.u_write.count) == n + 1 && 32'(left) == Beats - 1 - n);
        for (int i = 0; i < 2; i++) if (n >= i && n < i + Beats)
          assert (32'(dut.position_q[i]) == n - i && 32'(u_timing.beat_q[i]) == n - i);
        if (n >= Reads && n < Reads + Beats) reads: assert (32'(dut.read_position) == n - Reads);
        if (n <= Reads) frames: assert (dut.frame_start_q == u_timing.u_timing.frame_start_q[n]);
        if (n > Reads && n <= Reads + Beats) first: assert (dut.first == (n == Reads + 1));
      end
    end
  end

  logic [31:0] since, meet;  // clocks since the mode came; the age at which both modes meet
  assign since = 32'(age) - 2 - 32'(position) / Paths;
  assign meet = Delay + 2 + 32'(position) / Paths;
  for (genvar w = 0; w < 2 * Paths; w++) begin : g_word
    localparam bit OfA = w < Paths;
    logic here, mirrored;
    logic [Width-1:0] own, own_mirror, entry;
    assign here = started && following && path == w % Paths && 32'(age) > 2 + 32'(position) / Paths;
    assign mirrored = started && following && mirror_path == w % Paths && 32'(age) > 2 + 32'(mirror) / Paths;
    assign {own, own_mirror} = OfA ? {a, a_mirror} : {b, b_mirror};
    assign entry = dut.g_word[w].u_mirrored.u_ram.g_distributed.words[BeatWidth'(32'(mirror) / Paths)];
    always_comb begin
      if (mirrored && 32'(age) < meet - 1) stands: assert (entry == own_mirror);
      if (mirrored && 32'(age) == meet - 1) was_read: assert (dut.mirrored[w*Width+:Width] == own_mirror);
      if (here && 32'(age) == meet) late: assert (dut.beat[w*Width+:Width] == own);
    end
    if (Delay <= 4) begin : g_shift
      always_comb if (here && since <= Delay)
        on_way: assert (dut.g_word[w].u_beat.g_shift.taps[since-1] == own);
    end else begin : g_memory
      logic [$clog2(Delay)-1:0] slot;
      wire [$clog2(Delay)-1:0] pointer = dut.g_word[w].u_beat.g_memory.pointer;
      always_ff @(posedge clk) if (en && !here) slot <= pointer;
      always_comb begin
        if (started) in_range: assert (32'(pointer) < Delay);
        if (here && since < Delay) on_way: assert (32'(slot) < Delay
            && 32'(pointer) == (32'(slot) + since) % Delay
            && dut.g_word[w].u_beat.g_memory.u_ram.u_ram.g_distributed.words[slot] == own);
      end
    end
  end
  for (genvar l = 0; l < Paths; l++) begin : g_path
    always_comb begin
      if (started && following && path == l && 32'(age) == meet)
        sums: assert (dut.g_path[l].sum_re == sum_re && dut.g_path[l].sum_im == sum_im);
    end
  end
end

bind td_ram ram_check #(.Depth(Depth), .Defined(0), .Covered(0)) u_check (
  .clk, .write_en, .write_address, .read_en, .read_address
);
