// SPDX-License-Identifier: Apache-2.0
// fv_frame_tags: an arbitrary tag is due exactly Latency enabled clocks after it was pushed, unchanged, and nothing
// else is ever due; held is high just while there are tags.

parameter int Width = 1, Latency = 10, Pixels = 4;
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
    most_tags: cover (tags == (Latency + Pixels - 1) / Pixels && due);
    alone: cover (due && en && pushed[Latency-2:0] == '0);
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
