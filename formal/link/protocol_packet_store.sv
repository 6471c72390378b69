// SPDX-License-Identifier: Apache-2.0
// protocol_packet_store: a byte, or the end of a packet, or none; a good packet has 1 to 2047 bytes. Any consumer.
// What is offered counts while it is valid.

`default_nettype none

module protocol_packet_store (
  input  logic        clk,
  input  logic        rst,
  input  logic        in_valid,
  input  logic        in_end,
  input  logic        in_good,
  input  logic        out_valid,
  output logic [11:0] bytes,  // of the packet that comes; 2048 stands for more
  output logic        holds,
  output logic        counts_out_data,
  output logic        counts_out_last,
  output logic        counts_out_length,
  output logic        counts_out_length_mod3,
  output logic        counts
);

  logic live = 1'b0, reset;
  logic [11:0] count = '0;
  assign bytes = count;
  assign holds = ~(in_valid & in_end) & ~(in_end & in_good & (count == '0 | count[11]));
  assign reset = rst | ~holds;
  assign counts = live;
  assign counts_out_data = live & out_valid;
  assign {counts_out_last, counts_out_length, counts_out_length_mod3} = {3{counts_out_data}};
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (in_valid && !count[11]) count <= count + 12'd1;
    if (in_end || reset) count <= '0;
  end

endmodule

`default_nettype wire
