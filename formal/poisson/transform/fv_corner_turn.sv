// SPDX-License-Identifier: Apache-2.0
// fv_corner_turn: an arbitrary word of an arbitrary row and path leaves unchanged at its place in its row, which
// counts unless it is row b and row a came alone. Rows leave as in row_pair_timing.

parameter int Width = 1, Size = 8, Lanes = 4;
localparam int Paths = Lanes > 1 ? Lanes / 2 : 1, OutBeats = Size / Lanes;
localparam int PathWidth = Paths > 1 ? $clog2(Paths) : 1;
input logic pick, row_b;
input logic [PathWidth-1:0] chosen;

localparam int Beats = Size / Paths, BeatWidth = $clog2(Beats), Latency = Beats + 4,
    SlotWidth = Lanes > 1 ? $clog2(Lanes) : 1;

logic started, active;
logic [BeatWidth-1:0] beat;
row_pair_timing #(.Beats(Beats), .OutBeats(OutBeats), .Latency(Latency)) u_timing (.*);

// Even samples are the first half of the positions, odd ones the second half from its end.
logic [31:0] position, sample;
logic [PathWidth-1:0] path;
assign path = Paths > 1 ? chosen : '0;
assign position = 32'(path) * Beats + 32'(beat);
assign sample = position < Size / 2 ? 2 * position : 2 * (Size - 1 - position) + 1;

logic following, watched, held;
logic alone, alone_now;  // the burst present is row a alone
logic [1:0] begins, alone_q;
assign alone_now = begins[1] ? alone_q[1] : alone;
logic [7:0] left;  // enabled clocks to the one in which the word shall stand at the output
logic [SlotWidth-1:0] slot;
logic [Width-1:0] value;
assign watched = following & (left == '0);
kept #(.Width(Lanes * Width)) u_kept (.clk, .rst(1'b0), .en, .out(out_data), .held);
always_ff @(posedge clk) begin
  if (en) begin
    begins <= {begins[0], in_start};
    alone_q <= {alone_q[0], in_alone};
    alone <= alone_now;
    if (!following || watched) begin
      following <= pick & active & ~(row_b & alone_now);
      left <= 8'(Latency - 3 - 32'(beat) + 32'(row_b) * OutBeats + sample / Lanes);
      slot <= SlotWidth'(sample % Lanes);
      value <= row_b ? in_b[path*Width+:Width] : in_a[path*Width+:Width];
    end else begin
      left <= left - 8'd1;
    end
  end
  if (rst) {following, begins} <= '0;
end

always_comb begin
  if (started) begin
    if (watched) in_place: assert (out_data[slot*Width+:Width] == value);
    last_word: cover (watched && 32'(slot) == Lanes - 1 && held);
    row_begins: cover (watched && slot == '0 && out_start && en);
  end
end

// What makes the proof end.
// Steps of the proof: of each burst on its way, by the clocks since its start, where the writer and the reader of the core
// are, and that the word followed stands in its memory until it is read. All together follow from themselves in one
// clock, so induction ends.
if (1) begin : g_steps
  wire [BeatWidth:0] coming_left = u_timing.u_protocol.u_bursts.left;  // of the protocol: beats of the burst that are to come
  wire [1:0] active_q = u_timing.active_q;
  wire [1:0][BeatWidth-1:0] beat_q = u_timing.beat_q;
  wire picked = pick & active & ~(row_b & alone_now) & (~following | watched);  // the word present is followed from now on
  localparam int Reads = 2 * OutBeats, Longest = Beats + Reads + 4, Ahead = Lanes == 1 ? 1 : 0,
      Begins = Beats + 1 - Ahead;  // clocks from a start to the first read, less one

  function automatic logic [Longest-1:0] from_to(input int from, input int to);  // bits from .. to - 1
    from_to = '0;
    for (int n = 0; n < Longest; n++) from_to[n] = n >= from && n < to;
  endfunction

  // starts[n]: a burst began n + 1 enabled clocks ago; it has a row b; it is the first of a frame.
  logic [Longest-1:0] starts, seconds, frames;
  logic follows_b;
  logic [PathWidth-1:0] of_path;
  logic [BeatWidth-1:0] of_beat;
  always_ff @(posedge clk) begin
    if (en) begin
      starts <= {starts[Longest-2:0], in_start};
      seconds <= {seconds[Longest-2:0], in_start & ~in_alone};
      frames <= {frames[Longest-2:0], in_frame_start};
      if (picked) {follows_b, of_path, of_beat} <= {row_b, path, beat};
    end
    if (rst) {starts, seconds, frames} <= '0;
  end

  always_comb begin
    if (started) begin
      begins_late: assert (begins == starts[1:0]);
      alike: assert ((starts & frames) == frames && (starts & seconds) == seconds);
      timing_alike: assert (u_timing.start_q[Beats+3:0] == starts[Beats+3:0]
          && u_timing.frame_start_q == frames[Beats+3:0]
          && u_timing.second_q == seconds[Beats+OutBeats+3:0]);
      count: assert (dut.u_write.running == (coming_left != '0) && (coming_left == '0
          || dut.u_write.count == BeatWidth'((BeatWidth + 1)'(Beats) - coming_left)));
      burst: assert (32'(coming_left) < Beats && (coming_left == '0) == ((starts & from_to(0, Beats - 1)) == '0));
      late: assert (dut.active_q == active_q
          && active_q == {(starts & from_to(1, Beats + 1)) != '0, (starts & from_to(0, Beats)) != '0});
      if (active_q[0]) late_beat: assert (dut.position_q == beat_q[0]);
      if (active_q[1]) words_beat: assert (dut.beat == beat_q[1]);
      last: assert (dut.last_q == starts[Beats:Beats-1]);
      read_starts: assert (dut.read_start == starts[Begins]);
      read_runs: assert (dut.u_read.running == ((starts & from_to(Begins + 1, Begins + Reads)) != '0));
      if ((starts & from_to(1, Longest)) != '0)
        bank: assert (dut.write_bank_q == (dut.write_bank ^ starts[0]));
      rows_begin: assert (dut.row_start_q
          == (starts[Beats+3:Begins+1] | seconds[Beats+OutBeats+3:Begins+OutBeats+1])
          && dut.frame_row_q == frames[Beats+3:Begins+1]);
    end
  end

  // By the clocks since the start of a burst.
  logic [Longest-1:0] banks;  // in which it stands
  for (genvar n = 0; n < Longest; n++) begin : g_age
    assign banks[n] = dut.write_bank ^ (^(starts & from_to(0, n)));
    always_comb begin
      if (started && starts[n]) begin
        apart: assert ((starts & from_to(n + 1, n + Beats)) == '0);
        if (seconds[n]) apart_of_pairs: assert ((starts & from_to(n - Reads + 1, n)) == '0);
        if ((starts & from_to(0, n)) == '0) waits: assert (32'(u_timing.u_protocol.wait_left)
            == (n + 1 < (seconds[n] ? Reads : OutBeats) ? (seconds[n] ? Reads : OutBeats) - 1 - n : 0));
        if (n > 0 && n <= Beats) present_alone: assert (alone_now == ~seconds[n]);
        if (n < 2) starts_late: assert (begins[n] && alone_q[n] == ~seconds[n]);
        if (n < Beats - 1) in_burst: assert (32'(coming_left) == Beats - 1 - n);
        for (int i = 0; i < 2; i++) if (n >= i && n < Beats + i) assert (32'(beat_q[i]) == n - i);
        if (n < Beats) written: assert (dut.alone_q == ~seconds[n]
            && dut.frame_start_q == frames[n]);
        if (Ahead == 0 && n >= Beats && n < Beats + Reads && (starts & from_to(Beats, n)) == '0)
          turns: assert (dut.next_alone == ~seconds[n] && dut.next_frame_start == frames[n]);
        if (n >= Begins && n < Begins + Reads && (starts & from_to(Begins, n)) == '0) reader: assert (
            dut.read_alone == ~seconds[n] && dut.read_frame_start == frames[n] && dut.read_bank == banks[n]
            && (n == Begins || 32'(dut.u_read.count) == n - Begins));
      end
    end
  end

  // The word followed: when it is read, counted from the first read of its burst, and where it stands.
  logic [31:0] of_position, of_sample, read_time, age;
  logic second_half, in_bank;
  logic [BeatWidth-1:0] write_beat;
  logic [Lanes*Width-1:0] next_out;
  logic [Width-1:0] entry;
  assign of_position = 32'(of_path) * Beats + 32'(of_beat);
  assign second_half = of_position >= Size / 2;
  assign of_sample = second_half ? 2 * (Size - 1 - of_position) + 1 : 2 * of_position;
  assign read_time = (follows_b ? OutBeats : 0) + of_sample / Lanes;
  assign age = Beats + 3 + read_time - 32'(left);
  assign write_beat = of_beat ^ {BeatWidth{second_half}};
  assign in_bank = banks[$clog2(Longest)'(age)];
  assign next_out = dut.leaves;
  logic [1:0][1:0][Width-1:0] memory_words;  // with one lane, of each half and row
  wire [Width-1:0] memory_word = memory_words[second_half][follows_b];
  logic [1:0][1:0][Paths-1:0][Width-1:0] entries;  // in each half: with Paths 1 of each row, else of each memory
  logic [PathWidth-1:0] memory;
  assign entry = Paths == 1 ? entries[second_half][follows_b][0] : entries[second_half][0][memory];
  if (Paths == 1) begin : g_single
    assign memory = '0;
    for (genvar n = Begins + 1; n <= Begins + Reads && Ahead == 1; n++) begin : g_behind_read
      localparam int Read = n - 1 - Begins;
      always_comb if (started && starts[n] && (starts & from_to(Begins + 1, n)) == '0) selects: assert (
          dut.g_single.row_q[1] == (Read >= OutBeats) && dut.g_one_lane.odd_q[0] == 1'(Read % 2));
    end
    for (genvar half = 0; half < 2; half++) begin : g_entry
      for (genvar r = 0; r < 2; r++) begin : g_row
        assign memory_words[half][r] = dut.g_single.g_half[half].g_row[r].u_ram.word;
        assign entries[half][r] = dut.g_single.g_half[half].g_row[r].u_ram.u_ram.g_distributed
            .words[{in_bank, write_beat[BeatWidth-2:0]}];
        for (genvar n = 2; n < Longest; n++) begin : g_age
          for (genvar b = half * Beats / 2; b < (half + 1) * Beats / 2 && b < n - 1; b++) begin : g_beat
            localparam logic [BeatWidth-2:0] At = (BeatWidth - 1)'(half == 0 ? b : Beats - 1 - b);
            always_comb if (started && starts[n]) was_written: assert (dut.g_single.g_half[half]
                .g_row[r].u_ram.u_ram.u_check.written[{banks[n], At}]);
          end
        end
      end
    end
  end else begin : g_paths
    assign memory_words = '0;
    localparam int Turned = BeatWidth < PathWidth ? BeatWidth : PathWidth;
    logic [PathWidth-1:0] in_half, turn;
    assign in_half = second_half ? PathWidth'(Paths - 1) - of_path : of_path;
    assign turn = PathWidth'(write_beat[Turned-1:0]) << (PathWidth - Turned);
    assign memory = (in_half | (follows_b ? PathWidth'(Paths / 2) : '0)) ^ turn;
    for (genvar half = 0; half < 2; half++) begin : g_entry
      assign entries[half][1] = '0;
      for (genvar w = 0; w < Paths; w++) begin : g_memory
        assign entries[half][0][w] = dut.g_paths.g_half[half].g_memory[w].u_ram.u_ram.g_distributed
            .words[{in_bank, write_beat}];
        for (genvar n = 2; n < Longest; n++) begin : g_age
          for (genvar b = 0; b < Beats && b < n - 1; b++) begin : g_beat
            localparam logic [BeatWidth-1:0] At = BeatWidth'(half == 0 ? b : Beats - 1 - b);
            always_comb if (started && starts[n]) was_written: assert (dut.g_paths.g_half[half]
                .g_memory[w].u_ram.u_ram.u_check.written[{banks[n], At}]);
          end
        end
      end
    end
  end
  always_comb begin
    if (started && following) begin
      own_path: assert (32'(of_path) < Paths);
      in_time: assert (age >= 32'(of_beat) + 2 && age < Longest && starts[$clog2(Longest)'(age)]);
      if (follows_b) of_pair: assert (seconds[$clog2(Longest)'(age)]);
      own_slot: assert (slot == SlotWidth'(of_sample % Lanes));
      if (32'(left) >= 2 + Ahead) stands: assert (entry == value);
      if (Ahead == 1 && left == 8'd2) was_read_first: assert (memory_word == value);
      if (left == 8'd1) was_read: assert (next_out[slot*Width+:Width] == value);
    end
  end
end

bind td_ram ram_check #(.Depth(Depth)) u_check (
  .clk, .write_en, .write_address, .read_en, .read_address
);
