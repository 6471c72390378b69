// SPDX-License-Identifier: Apache-2.0
// fv_wide_corner_turn: an arbitrary word of an arbitrary row and path leaves unchanged at its place in its row, which
// counts unless it is row b and row a came alone. Rows leave as in row_pair_timing.

parameter int Width = 1, Size = 8, Paths = 2;
localparam int PathWidth = Paths > 1 ? $clog2(Paths) : 1;
input logic pick, row_b;
input logic [PathWidth-1:0] chosen;

localparam int Beats = Size / Paths, BeatWidth = $clog2(Beats), Latency = Beats + 4, SlotWidth = $clog2(2 * Paths);

logic started, active;
logic [BeatWidth-1:0] beat;
row_pair_timing #(.Beats(Beats), .Latency(Latency)) u_timing (.*);

// Even samples are the first half of the positions, odd ones the second half from its end.
logic [31:0] position, sample;
logic [PathWidth-1:0] path;
assign path = Paths > 1 ? chosen : '0;
assign position = 32'(path) * Beats + 32'(beat);
assign sample = position < Size / 2 ? 2 * position : 2 * (Size - 1 - position) + 1;

logic following, watched, held;
logic [7:0] left;  // enabled clocks to the one in which the word shall stand at the output
logic [SlotWidth-1:0] slot;
logic [Width-1:0] value;
assign watched = following & (left == '0);
kept #(.Width(2 * Paths * Width)) u_kept (.clk, .rst(1'b0), .en, .out(out_data), .held);
always_ff @(posedge clk) begin
  if (en) begin
    if (!following || watched) begin
      following <= pick & active;
      left <= 8'(Latency - 3 - 32'(beat) + 32'(row_b) * (Beats / 2) + sample / (2 * Paths));
      slot <= SlotWidth'(sample);
      value <= row_b ? in_b[path*Width+:Width] : in_a[path*Width+:Width];
    end else begin
      left <= left - 8'd1;
    end
  end
  if (rst) following <= 1'b0;
end

always_comb begin
  if (started) begin
    if (watched) in_place: assert (out_data[slot*Width+:Width] == value);
    last_word: cover (watched && slot == '1 && held);
    row_begins: cover (watched && slot == '0 && out_start && en);
  end
end

// What makes the proof end.
wide_corner_turn_steps #(.Width(Width), .Size(Size), .Paths(Paths)) u_steps (
  .*, .coming_left(u_timing.u_protocol.left), .active_q(u_timing.active_q), .beat_q(u_timing.beat_q),
  .picked(pick & active & (~following | watched))
);

bind td_ram ram_check #(.Depth(Depth)) u_check (
  .clk, .write_en, .write_address, .read_en, .read_address
);
