// SPDX-License-Identifier: Apache-2.0
// fv_frame_tags: an arbitrary tag is due exactly Latency enabled clocks after it was pushed, unchanged, and nothing
// else is ever due; held is high just while there are tags; then, for Keep enabled clocks, its late part is there, and
// whether it was marked.

parameter int Width = 1, LateWidth = 1, Latency = 10, Keep = 2, Pixels = 4;
input logic pick;

logic [Latency-1:0] pushed;
logic followed_due;
logic [Width-1:0] value;
follow_delay #(.Width(Width), .Latency(Latency)) u_follow (
  .clk, .rst, .en, .pick(pick & push), .in(tag), .due(followed_due), .word(value)
);
always_ff @(posedge clk) begin
  if (en) pushed <= Latency'({pushed, push});
  if (rst) pushed <= '0;
end

// The late part of the tag that was pushed last, and of the picked one; the age of that, in enabled clocks.

localparam int AgeWidth = $clog2(Latency + Keep + 2);
logic newest, has_part, is_marked, ages;
logic [LateWidth-1:0] part;
logic [AgeWidth-1:0] age;
always_ff @(posedge clk) begin
  is_marked <= is_marked | mark;
  if (en) begin
    if (ages) age <= age + AgeWidth'(1);
    if (age == AgeWidth'(Latency + Keep)) ages <= 1'b0;
    if (newest && late) {has_part, part} <= {1'b1, late_part};
    if (push) newest <= 1'b0;
    if (push && pick && !ages) begin
      {newest, ages, has_part, is_marked} <= {3'b110, marked | mark};
      age <= AgeWidth'(1);
    end
  end
  if (rst) {newest, ages, has_part} <= '0;
end

int tags;  // on their way
always_comb begin
  tags = 0;
  for (int i = 0; i < Latency; i++) tags += 32'(pushed[i]);
end

always_comb begin
  if (started) begin
    due_just_then: assert (due == pushed[Latency-1]);
    if (followed_due) own_tag: assert (due && due_tag == value);
    held_meanwhile: assert (held == (pushed != '0));
    if (ages && age > AgeWidth'(Latency)) begin
      own_mark: assert (late_marked == is_marked);
      if (has_part) own_part: assert (late_tag == part);
    end
    most_tags: cover (tags == (Latency + Pixels - 1) / Pixels && due);
    alone: cover (due && en && pushed[Latency-2:0] == '0);
    kept: cover (ages && has_part && age == AgeWidth'(Latency + Keep) && part == '1 && is_marked);
  end
end

// Protocol: frames end at least Pixels enabled clocks apart.
module protocol_frame_tags;
  localparam int CountWidth = $clog2(Pixels + 1);
  logic [CountWidth-1:0] left = '0;  // enabled clocks until the next push may come
  assign holds = ~push | rst | left == '0;
  assign counts = live;
  always_ff @(posedge clk) begin
    if (reset) left <= '0;
    else if (en) left <= push ? CountWidth'(Pixels - 1) : left - CountWidth'(left != '0);
  end
endmodule
