// SPDX-License-Identifier: Apache-2.0
// fv_row_pairs: an arbitrary word of an arbitrary burst, with zeros around it in this burst, leaves at the positions of
// its mode k and of N - k: a word of row a in the imaginary part of k and the real part of N - k, one of row b negated in
// the real part of k, and in the imaginary part of N - k. The other words of the burst are 0. Mode 0 has no partner. By
// sums this holds of every burst. Latency Beats / 2 + 3.

parameter int Width = 2, Size = 8, Paths = 2;
input logic pick;  // free: the burst that begins is followed
input logic [$clog2(2*Size)-1:0] where;  // free and constant: row and position followed

localparam int PositionWidth = $clog2(Size);
localparam int Beats = Size / Paths;  // of a burst
localparam int BeatWidth = $clog2(Beats), Latency = Beats / 2 + 3;

logic started, active;
logic [BeatWidth-1:0] beat;
beat_timing #(.Beats(Beats), .Latency(Latency)) u_timing (.*);

// The place followed stays.
logic [$clog2(2*Size)-1:0] where_q;
always_ff @(posedge clk) where_q <= where;
always_comb if (started) assume (where == where_q);

// Its position in bit-reversed order, and that of mode N - k.
function automatic logic [PositionWidth-1:0] reversed(input logic [PositionWidth-1:0] word);
  for (int b = 0; b < PositionWidth; b++) reversed[b] = word[PositionWidth-1-b];
endfunction
logic row_b;
logic [PositionWidth-1:0] position, mirror;
logic [31:0] at, path;
assign {row_b, position} = where;
assign at = 32'(position) / Paths;
assign path = 32'(position) % Paths;
assign mirror = reversed(PositionWidth'(Size - 32'(reversed(position))));

// The burst followed: its word, then what leaves.
logic following, coming, leaving;
logic [7:0] age;  // enabled clocks since its start
logic signed [Width-1:0] value, negated;
assign coming = following & (age >= 8'd2) & (age < 8'(2 + Beats));
assign leaving = following & (age >= 8'(Latency + 2)) & (age < 8'(Latency + 2 + Beats));
always_ff @(posedge clk) begin
  if (en) begin
    if (following) age <= age + 8'd1;
    if (!following || age == 8'(Latency + 1 + Beats)) begin
      following <= pick & in_start;
      age <= 8'd1;
    end
    if (coming && 32'(beat) == at) value <= row_b ? in_b[path*Width+:Width] : in_a[path*Width+:Width];
  end
  if (rst) following <= 1'b0;
end
always_comb begin
  if (coming) begin
    for (int w = 0; w < Paths; w++) begin
      if (32'(beat) != at || w != path || row_b) assume (in_a[w*Width+:Width] == '0);
      if (32'(beat) != at || w != path || !row_b) assume (in_b[w*Width+:Width] == '0);
    end
  end
end
assign negated = value == $signed({1'b1, {(Width - 1){1'b0}}}) ? $signed({1'b0, {(Width - 1){1'b1}}}) : -value;

logic [BeatWidth-1:0] out_beat;
assign out_beat = BeatWidth'(age - 8'(Latency + 2));
for (genvar path = 0; path < Paths; path++) begin : g_path
  logic [PositionWidth-1:0] here;
  logic of_mode, of_mirror;
  logic signed [Width-1:0] re, im;
  assign here = PositionWidth'(32'(out_beat) * Paths + path);
  assign of_mode = here == position;
  assign of_mirror = here == mirror && position != '0;
  assign re = row_b ? (of_mode ? negated : '0) : of_mirror ? value : '0;
  assign im = row_b ? (of_mirror ? value : '0) : of_mode ? value : '0;
  always_comb begin
    if (started && leaving) begin
      real_part: assert (out_re[path*Width+:Width] == re);
      imaginary_part: assert (out_im[path*Width+:Width] == im);
      partner: cover (of_mirror && !of_mode && value == '1 && en);
    end
  end
end

bind td_ram ram_check #(.Depth(Depth), .Defined(0), .Covered(0)) u_check (
  .clk, .write_en, .write_address, .read_en, .read_address
);
