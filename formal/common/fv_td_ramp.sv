// SPDX-License-Identifier: Apache-2.0
// fv_td_ramp: an arbitrary word of the ramp is the first and so many steps, log2(Count) enabled clocks after both came; with
// en low it stands.

parameter int Width = 6, StepWidth = 4, Count = 4;
input logic [Levels:0] chosen;

// What came n enabled clocks ago is in field n.
logic [(Levels+1)*Width-1:0] firsts;
logic [(Levels+1)*StepWidth-1:0] steps;
logic [Levels:0] known;
assign firsts[Width-1:0] = first;
assign steps[StepWidth-1:0] = step;
assign known[0] = 1'b1;
logic held = 1'b0;
logic [Count*Width-1:0] out_q;
for (genvar n = 1; n <= Levels; n++) begin : g_q
  logic knows = 1'b0;
  assign known[n] = knows;
  always_ff @(posedge clk) begin
    if (en) begin
      firsts[n*Width+:Width] <= firsts[(n-1)*Width+:Width];
      steps[n*StepWidth+:StepWidth] <= steps[(n-1)*StepWidth+:StepWidth];
      knows <= known[n-1];
    end
  end
end
always_ff @(posedge clk) begin
  out_q <= out;
  held <= Levels > 0 && !en;
end

logic [Width-1:0] word, expected;
assign word = Width'(out >> 32'(chosen) * Width);
assign expected = firsts[Levels*Width+:Width]
    + Width'(chosen) * Width'($signed(steps[Levels*StepWidth+:StepWidth]));
always_comb begin
  if (known[Levels] && 32'(chosen) < Count) in_its_place: assert (word == expected);
  if (held) holds: assert (out == out_q);
  falls: cover (known[Levels] && 32'(chosen) == Count - 1 && word != '0 && (Count == 1
      || word < firsts[Levels*Width+:Width]));
end
