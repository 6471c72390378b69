// SPDX-License-Identifier: Apache-2.0
// fv_td_repeat_check: a frame with the words of the frame before, from one bank, is never called different; one with a
// single other bit always is, two clocks after its last word. Frames of three words that are cut short at times, any
// gaps, any en.

parameter int Width = 21;
localparam int Words = 3;

wire takes = en & in_valid;
logic [1:0] place;  // of the word that comes next in its frame, 0: none has begun
logic [Words-1:0][Width-1:0] earlier, earlier_q, now;  // the last whole frame, the one before it, the one that comes
logic bank, whole, same_bank;  // whole: the frame that came last
logic ended, ended_alike, ended_flipped;  // a clock ago, and its frame was to be compared
logic [Words-1:0][Width-1:0] with_this, apart;
wire [1:0] here = in_first ? 2'd0 : place;
wire ends = takes & (here == 2'(Words - 1));
assign apart = with_this ^ earlier;
always_comb begin
  with_this = now;
  with_this[here] = in_data;
  assume (!takes || (in_first || place != '0) && in_last == (here == 2'(Words - 1)));
end
always_ff @(posedge clk) begin
  if (takes) begin
    place <= ends ? '0 : here + 2'd1;
    now[here] <= in_data;
    whole <= ends;
    if (in_first) {bank, same_bank} <= {in_bank, whole & (in_bank == bank)};
    if (ends) {earlier_q, earlier} <= {earlier, with_this};
  end
  ended <= ends & same_bank;
  ended_alike <= apart == '0;
  ended_flipped <= apart != '0 && (apart & (apart - 1'b1)) == '0;
  if (rst) {place, whole, same_bank, ended} <= '0;
end

// Where they are in the core.
function automatic logic [18:0] signature(input logic [Words-1:0][Width-1:0] words, input int count);
  signature = '0;
  for (int n = 0; n < Words; n++) begin
    if (n < count) signature = {signature[17:0], signature[18]} ^ 19'(words[n]) ^ 19'(words[n] >> 19);
  end
endfunction
logic told_alike, told_flipped, ended_last;
always_ff @(posedge clk) begin
  told_alike <= ended & ended_alike & ~rst;
  told_flipped <= ended & ended_flipped & ~rst;
  ended_last <= ends & ~rst;
end

always_comb begin
  if (started) begin
    if (place != '0) so_far: assert (dut.signature == signature(now, 32'(place)));
    if (ended_last) at_end: assert (dut.signature == signature(earlier, Words) && dut.ends && dut.compares == ended);
    if (ended) kept: assert (whole && dut.signature_before == signature(earlier_q, Words));
    if (!ended_last && (whole || (place != '0 && same_bank))) waits: assert (
        dut.signature_before == signature(earlier, Words));
    if (ended) known: assert (ended_last && ended_alike == (earlier == earlier_q));
    if (!ended_last) no_end: assert (!dut.ends);
    flags: assert (dut.whole == whole && (place == '0 || dut.compares == same_bank) && (!whole || dut.bank == bank));
    if (place != '0) banks: assert (dut.bank == bank);
    if (told_alike) alike: assert (!differs);
    if (told_flipped) flipped: assert (differs);
    flip_seen: cover (told_flipped && differs);
    repeats: cover (told_alike && place != '0);
  end
end

// Protocol: frames begin with their first word.
module protocol_td_repeat_check;
  logic begun = 1'b0;
  assign holds = ~in_valid | in_first | begun;
  always_ff @(posedge clk) begin
    if (en & in_valid) begun <= ~in_last;
    if (reset) begun <= 1'b0;
  end
endmodule
