// SPDX-License-Identifier: Apache-2.0
// fv_commutator: an arbitrary word of an arbitrary path leaves unchanged at its position, which has another path
// and beat behind the core; start and frame_start Delay enabled clocks behind those that came in.

parameter int Width = 1, Paths = 4, Beats = 4, Delay = 2, Up = 1;
localparam int PathWidth = $clog2(Paths);
input logic pick;
input logic [PathWidth-1:0] chosen;

localparam int BeatWidth = $clog2(Beats), PositionWidth = PathWidth + BeatWidth;
localparam int Low = $clog2(Delay) + (Up != 0 ? 0 : 1);  // lowest bit of the position in the path number, before
localparam int Behind = $clog2(Delay) + (Up != 0 ? 1 : 0), LeftWidth = $clog2(Delay + Beats + 1);

logic started, active;
logic [BeatWidth-1:0] beat;
beat_timing #(.Beats(Beats), .Latency(Delay)) u_timing (.*);

// Position of the chosen word, and its path and beat behind the core.
logic [PositionWidth-1:0] position;
logic [PathWidth-1:0] path;
logic [BeatWidth-1:0] leaves;
assign position = PositionWidth'((32'(beat) >> Low << (Low + PathWidth)) | (32'(chosen) << Low)
    | (32'(beat) % (1 << Low)));
assign path = PathWidth'(position >> Behind);
assign leaves = BeatWidth'((32'(position) >> (Behind + PathWidth) << Behind) | (32'(position) % (1 << Behind)));

logic following, watched, now;
logic [LeftWidth-1:0] wait_for, left;  // enabled clocks to the one in which the word shall stand at the output
logic [PathWidth-1:0] path_q;
logic [2*Width-1:0] value, word;
assign word = {in_re[chosen*Width+:Width], in_im[chosen*Width+:Width]};
assign wait_for = LeftWidth'(Delay + 32'(leaves) - 32'(beat));
assign now = pick & active & (wait_for == '0);
assign watched = following & (left == '0);
always_ff @(posedge clk) begin
  if (en) begin
    if (!following || watched) begin
      following <= pick & active & ~now;
      left <= wait_for - LeftWidth'(1);
      path_q <= path;
      value <= word;
    end else begin
      left <= left - LeftWidth'(1);
    end
  end
  if (rst) following <= 1'b0;
end

always_comb begin
  if (started) begin
    if (watched) in_place: assert ({out_re[path_q*Width+:Width], out_im[path_q*Width+:Width]} == value);
    if (now) at_once: assert ({out_re[path*Width+:Width], out_im[path*Width+:Width]} == word);
    passes: cover (now && en);
    waits: cover (watched && path_q == '1 && en);
  end
end
