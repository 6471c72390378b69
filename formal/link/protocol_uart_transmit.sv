// SPDX-License-Identifier: Apache-2.0
// protocol_uart_transmit: a byte that is offered stays until it is taken.

`default_nettype none

module protocol_uart_transmit (
  input  logic       clk,
  input  logic       rst,
  input  logic       in_valid,
  input  logic       in_ready,
  input  logic [7:0] in_data,
  output logic       holds,
  output logic       counts
);

  logic reset, live = 1'b0;
  assign reset = rst | ~holds;
  assign counts = live & ~reset;
  always_ff @(posedge clk) live <= live | reset;
  offer_stays #(.Width(8)) u_in (.clk, .rst, .reset, .valid(in_valid), .ready(in_ready), .word(in_data), .holds);

endmodule

`default_nettype wire
