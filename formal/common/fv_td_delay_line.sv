// SPDX-License-Identifier: Apache-2.0
// fv_td_delay_line: out is in, Delay enabled clocks later, for an arbitrary word; out holds while en is low.
//
// What leaves in the first Delay enabled clocks after a reset is no one's word: a memory that has not been written is
// read there. Those who use the line look only later, which their own proofs show.

`default_nettype none

module fv_td_delay_line #(
  parameter int Width = 1,
  parameter int Delay = 5,
  localparam int CountWidth = $clog2(Delay + 1)
) (
  input logic             clk,
  input logic             rst,
  input logic             en,
  input logic [Width-1:0] in,
  input logic             pick
);

  logic [Width-1:0] out;
  td_delay_line #(.Width(Width), .Delay(Delay)) dut (.clk, .rst, .en, .in, .out);

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  logic following, held;
  logic [CountWidth-1:0] age;  // enabled clocks since the word followed was present
  logic [Width-1:0] value, out_q;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    held <= ~en;
    out_q <= out;
    if (en) begin
      if (!following || age == CountWidth'(Delay)) begin
        following <= pick;
        age <= CountWidth'(1);
        value <= in;
      end else begin
        age <= age + CountWidth'(1);
      end
    end
    if (rst) following <= 1'b0;
  end

  always_comb begin
    if (started) begin
      if (following && age == CountWidth'(Delay)) delayed: assert (out == value);
      if (held) holds: assert (out == out_q);
      word_out: cover (following && age == CountWidth'(Delay) && value == '1);
      word_out_paused: cover (following && age == CountWidth'(Delay) && held && value == '0);
    end
  end

  if (Delay > 4) begin : g_memory  // longer than the longest shift register
    bind fv_td_delay_line.dut.g_memory.u_ram ram_check #(.Depth(Depth), .Defined(0)) u_check (
      .clk, .write_en, .write_address, .read_en, .read_address
    );
  end

endmodule

`default_nettype wire
