// SPDX-License-Identifier: Apache-2.0
// fv_mode_pairs: an arbitrary word leaves Size / 2 + 1 enabled clocks later as out_mode, and once as out_mirrored,
// beside the mode whose number adds up to Size with its own; mode 0 has 0 beside it. start and frame_start with the
// first of a burst.

parameter int Width = 1, Size = 8;
input logic pick;

localparam int PositionWidth = $clog2(Size), Latency = Size / 2 + 2, AgeWidth = PositionWidth + 2;

logic started, active;
logic [PositionWidth-1:0] position;

// Position of a mode: its number with the bits reversed; its mirror is Size minus its number.
function automatic logic [PositionWidth-1:0] reversed(input logic [PositionWidth-1:0] word);
  logic [PositionWidth-1:0] result;
  for (int b = 0; b < PositionWidth; b++) result[b] = word[PositionWidth-1-b];
  return result;
endfunction
logic [PositionWidth-1:0] mirror;
assign mirror = reversed(PositionWidth'(Size - 32'(reversed(position))));

logic following, has_mirror;
logic [AgeWidth-1:0] age, mirror_age;  // enabled clocks since the word was present; when it shall be beside another
logic signed [Width-1:0] value;
logic held;
logic done;
assign done = age >= AgeWidth'(Latency) && (!has_mirror || age >= mirror_age);
kept #(.Width(2 * Width + 2)) u_kept (.clk, .rst, .en, .out({out_start, out_frame_start, out_mode, out_mirrored}), .held);
always_ff @(posedge clk) begin
  if (en) begin
    if (!following || done) begin
      following <= pick & active;
      age <= AgeWidth'(1);
      value <= in_mode;
      has_mirror <= position != '0;
      mirror_age <= AgeWidth'(Latency) + AgeWidth'(mirror) - AgeWidth'(position);
    end else begin
      age <= age + AgeWidth'(1);
    end
  end
  if (rst) following <= 1'b0;
end

burst_timing #(.Columns(Size), .Latency(Latency)) u_timing (.*, .row());
always_comb begin
  if (started) begin
    if (following && age == AgeWidth'(Latency)) mode_in_place: assert (out_mode == value);
    if (following && has_mirror && age == mirror_age) mirror_in_place: assert (out_mirrored == value);
    if (out_start) mode_0_alone: assert (out_mirrored == '0);
    early_mirror: cover (following && age == mirror_age && mirror_age < AgeWidth'(Latency));
    late_mirror: cover (following && age == mirror_age && mirror_age > AgeWidth'(Latency) && held);
    own_mirror: cover (following && has_mirror && age == AgeWidth'(Latency) && age == mirror_age);
  end
end

bind dut.u_ram ram_check #(.Depth(Depth)) u_check (.*);
