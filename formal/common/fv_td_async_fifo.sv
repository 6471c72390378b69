// SPDX-License-Identifier: Apache-2.0
// fv_td_async_fifo: no word is lost, repeated, reordered or changed, none is offered that was not written, for clocks of any
// ratio; an offer stays until it is taken; a word is offered, and room is seen, a few clocks after there is any.
//
// Both clocks are inputs that may rise or not in any step of time, each whenever it likes. A bit that crosses shows its
// new value or that before the last edge of its clock, each bit and each step by itself: the delay of a wire below one
// period, and a register that catches it in motion. One arbitrary word is followed: `pick` is free.

parameter int Width = 1, DepthLog2 = 2;
input logic [DepthLog2:0] written_late, fetched_late;
input logic pick;

localparam int Depth = 1 << DepthLog2, CountWidth = DepthLog2 + 2;

// Words, modulo 2^CountWidth: fewer are inside.

logic [CountWidth-1:0] written = '0, left = '0, number = '0, held;
logic followed = 1'b0, done = 1'b0;
logic [Width-1:0] value;
assign held = written - left;
logic [DepthLog2:0] written_caught, fetched_caught;
logic stalled = 1'b0;
logic [Width-1:0] stalled_data;
logic [2:0] waited = '0, refused = '0;  // clocks in which a code has arrived and nothing is made of it yet
logic [2:0] passed = '0;

always_ff @(posedge write_clk) begin
  if (write_valid && write_ready) begin
    written <= written + CountWidth'(1);
    if (pick && !followed) begin
      followed <= 1'b1;
      number <= written;
      value <= write_data;
    end
  end
  refused <= write_ready || 32'(held) >= Depth || fetched_caught != dut.fetched_code ? '0 : refused + 3'd1;
end
always_ff @(posedge read_clk) begin
  stalled <= read_valid & ~read_ready;
  stalled_data <= read_data;
  if (read_valid && read_ready) begin
    left <= left + CountWidth'(1);
    if (followed && left == number) done <= 1'b1;
    if (passed != '1) passed <= passed + 3'd1;
  end
  waited <= read_valid || held == '0 || written_caught != dut.written_code ? '0 : waited + 3'd1;
end

code_wires #(.Width(DepthLog2 + 1)) u_written (
  .from_clk(write_clk), .code(dut.written_code), .to_clk(read_clk), .late(written_late), .caught(written_caught)
);
code_wires #(.Width(DepthLog2 + 1)) u_fetched (
  .from_clk(read_clk), .code(dut.fetched_code), .to_clk(write_clk), .late(fetched_late), .caught(fetched_caught)
);

// Behind the proof: fetched, known to the reader, caught, written follow each other; and so the other way.

function automatic logic [DepthLog2:0] binary(input logic [DepthLog2:0] code);
  binary = code;
  for (int place = DepthLog2 - 1; place >= 0; place--) binary[place] ^= binary[place+1];
endfunction

logic [DepthLog2:0] ahead, ahead_caught, ahead_known, behind_caught, behind_known;
assign ahead = dut.written - dut.fetched;
assign ahead_caught = binary(dut.written_code_q) - dut.fetched;
assign ahead_known = binary(dut.written_code_q2) - dut.fetched;
assign behind_caught = dut.written - binary(dut.fetched_code_q);
assign behind_known = dut.written - binary(dut.fetched_code_q2);

always_comb begin
  assume (dut.written_code_q == written_caught);
  assume (dut.fetched_code_q == fetched_caught);
  capacity: assert (32'(held) <= Depth + 1);
  writer_counts: assert (dut.written == written[DepthLog2:0]);
  reader_counts: assert (dut.fetched == left[DepthLog2:0] + (DepthLog2 + 1)'(read_valid));
  written_code: assert (binary(dut.written_code) == dut.written);
  fetched_code: assert (binary(dut.fetched_code) == dut.fetched);
  written_in_order: assert (ahead_known <= ahead_caught && ahead_caught <= ahead && 32'(ahead) <= Depth);
  fetched_in_order: assert (ahead <= behind_caught && behind_caught <= behind_known && 32'(behind_known) <= Depth);
  nothing_from_nothing: assert (!read_valid || held != '0);
  if (followed && !done) still_inside: assert (CountWidth'(written - number) <= held && number != written);
  if (followed && !done && read_valid && number == left) in_place: assert (read_data == value);
  if (followed && !done && !(read_valid && number == left)) kept: assert (dut.words[number[DepthLog2-1:0]] == value);
  if (stalled) stays: assert (read_valid && read_data == stalled_data);
  if (held != '0) offered: assert (waited < 3'd4);
  if (32'(held) < Depth) room_seen: assert (refused < 3'd4);
  full: cover (32'(held) == Depth + 1 && followed && !done && number == left + CountWidth'(2));
  empty_again: cover (passed == '1 && held == '0 && done);
  streams: cover (passed == '1 && 32'(held) > 2);
  codes_in_a_row: cover (dut.written_code_q != dut.written_code && dut.written_code_q != dut.written_code_q2);
end
