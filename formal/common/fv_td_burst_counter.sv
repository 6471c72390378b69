// SPDX-License-Identifier: Apache-2.0
// fv_td_burst_counter: position is the number of enabled clocks since the last start, active while that is less than
// Words.

parameter int Words = 8;

logic [PositionWidth:0] since, age;  // enabled clocks from the last start to this clock; Words: none, or long ago
assign age = start ? '0 : since;
always_ff @(posedge clk) begin
  if (en) since <= age == (PositionWidth + 1)'(Words) ? age : age + (PositionWidth + 1)'(1);
  if (rst) since <= (PositionWidth + 1)'(Words);
end

always_comb begin
  if (started) begin
    whole_burst: assert (active == (age < (PositionWidth + 1)'(Words)));
    if (active) in_order: assert ((PositionWidth + 1)'(position) == age);
    after_burst: cover (!active && en);
    begins_again: cover (start && since != '0 && since < (PositionWidth + 1)'(Words));
  end
end

logic ended;
always_ff @(posedge clk) ended <= en & (age == (PositionWidth + 1)'(Words - 1)) & ~rst;
always_comb if (started && ended && Words < 256) back_to_back: cover (start);
