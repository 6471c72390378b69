// SPDX-License-Identifier: Apache-2.0
// fv_frame_ring: an arbitrary word of a frame is read in its turn, unchanged and not called flipped, if its frame is the
// latest one that is whole when reading begins; with Late, if it is that or the one before as the header says. Frames
// may be cut short; both sides pause as they like.

parameter int Width = 1, Words = 3, Held = 8, LastFirst = 1, Late = 0, Parity = 1;
localparam int Size = 1 << $clog2(Held), Half = Late == 0 ? 0 : 1 << ($clog2(Late) - 1), A = $clog2(Held);
input logic pick;

// The word: its place in its frame, the words behind it. Its frame: whole, and whether a later one is.
logic begun, followed, frame_whole, later_whole;
logic [31:0] number, place, behind, since;  // number: of the word that comes next; since: cycles, of the latest frame
logic [Width-1:0] value;
wire takes = en & in_valid;
wire [31:0] now = in_frame_start ? 0 : number;
wire ends = takes & (now == Words - 1);
always_comb assume (!takes || in_frame_start || (begun && number < Words));

// Reading: begun with its frame, words asked for; the word behind the memory, and in its register.
logic reads, in_memory, in_register;
logic [1:0] was_out;  // one and two cycles ago
logic [31:0] asked;
wire chooses = out_en & out_frame_start;
wire own = followed & frame_whole & (later_whole ? Late != 0 && since < Half : Late == 0 || since == Half);
wire hits = reads & ~chooses & (asked == (LastFirst != 0 ? Words - 1 - place : place));
wire keeps = followed & ~(takes & behind == Size - 1) & ~(ends & later_whole)
    & ~(takes & ~frame_whole & in_frame_start);
always_ff @(posedge clk) begin
  if (takes) begin
    begun <= 1'b1;
    number <= now + 1;
    behind <= behind + 1;
  end
  if (en && ends) since <= '0;
  else if (en && since < Half) since <= since + 1;
  if (!followed) begin
    followed <= pick & takes;
    place <= now;
    value <= in_data;
    behind <= '0;
    frame_whole <= ends;
    later_whole <= 1'b0;
  end else begin
    followed <= keeps;
    frame_whole <= frame_whole | ends;
    later_whole <= later_whole | (frame_whole & ends);
  end
  if (chooses) asked <= '0;
  else if (out_en && out_next) asked <= asked + 1;
  reads <= keeps & (chooses ? own : reads);
  if (out_en && out_next) in_memory <= hits;
  if (out_en) in_register <= in_memory;
  if (!keeps) {in_memory, in_register} <= '0;
  was_out <= {was_out[0], in_register};
  if (rst) begin
    {begun, followed, reads, in_memory, in_register, was_out} <= '0;
    number <= '0;
  end
end

// Where they are in the core.
wire [A-1:0] at = dut.write_address - A'(behind) - 1'b1;
wire [A-1:0] first = at - A'(place), last = first + A'(Words - 1);
wire [Width:0] entry = dut.u_words.u_ram.g_block.words[at];
wire [Width:0] stored = {^value, value};
always_comb begin
  if (started) begin
    counted: assert (number <= Words && (!begun || (32'(dut.word_next) == number % (1 << $clog2(Words))
        && dut.first_address == dut.write_address - A'(number))));
    if (followed) begin
      in_ring: assert (place < Words && behind < Size && begun && entry == stored);
      if (!frame_whole) comes: assert (number == place + behind + 1 && !later_whole);
      if (frame_whole && !later_whole) latest: assert (dut.latest == (LastFirst != 0 ? last : first));
    end
    if (reads) turn: assert (followed && frame_whole
        && dut.read_address == (LastFirst != 0 ? last - A'(asked) : first + A'(asked)));
    if (in_memory) behind_memory: assert (followed && dut.u_words.word == stored);
    if (in_register) is_read: assert (followed && out_data == value);
    if (was_out[1]) not_flipped: assert (!flipped);
    read_twice: cover (in_register && asked == Words && out_next);
  end
end
if (Late != 0) begin : g_earlier
  always_comb begin
    if (started && followed && frame_whole) cycles: assert (since <= Half && 32'(dut.g_late.since) == since);
    if (started && followed && later_whole) earlier: assert (dut.g_late.earlier == (LastFirst != 0 ? last : first));
    if (started) of_earlier: cover (in_register && later_whole);
  end
end
