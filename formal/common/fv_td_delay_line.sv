// SPDX-License-Identifier: Apache-2.0
// fv_td_delay_line: out is in, Delay enabled clocks later, for an arbitrary word; out holds while en is low.
//
// What leaves in the first Delay enabled clocks after a reset is no one's word: a memory that has not been written is
// read there. Those who use the line look only later, which their own proofs show.

parameter int Width = 1, Delay = 5, Style = 3, Parity = 0;
input logic pick;

logic due, held;
logic [Width-1:0] value;
follow_delay #(.Width(Width), .Latency(Delay)) u_follow (.clk, .rst, .en, .pick, .in, .due, .word(value));
kept #(.Width(Width)) u_kept (.clk, .rst(1'b0), .en, .out, .held);

always_comb begin
  if (started) begin
    if (due) delayed: assert (out == value);
    word_out: cover (due && value == '1);
    word_out_paused: cover (due && held && value == '0);
  end
end

if (Delay > 4 && Style != 4) begin : g_memory  // longer than the longest shift register
  bind dut.g_memory.u_ram ram_check #(.Depth(Depth), .Defined(0)) u_check (.*);
end

// Protocol: any inputs; out counts once Delay words came in after a reset.
module protocol_td_delay_line;
  logic [7:0] words = '0;
  assign counts_out = words == 8'(Delay) & ~rst;
  always_ff @(posedge clk) words <= rst ? '0 : words + 8'(en & live & words != 8'(Delay));
endmodule
