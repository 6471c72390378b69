// SPDX-License-Identifier: Apache-2.0
// protocol_crc_append: a byte that is offered stays until it is taken; bytes that leave count while they are valid.

`default_nettype none

module protocol_crc_append (
  input  logic       clk,
  input  logic       rst,
  input  logic       in_valid,
  input  logic       in_ready,
  input  logic [7:0] in_data,
  input  logic       in_last,
  input  logic       out_valid,
  output logic       holds,
  output logic       counts_out_data,
  output logic       counts_out_last,
  output logic       counts
);

  logic live = 1'b0, reset;
  assign reset = rst | ~holds;
  offer_stays #(.Width(9)) u_in (
    .clk, .rst, .reset, .valid(in_valid), .ready(in_ready), .word({in_last, in_data}), .holds
  );
  assign counts = live & ~reset;
  assign {counts_out_data, counts_out_last} = {2{counts & out_valid}};
  always_ff @(posedge clk) live <= live | reset;

endmodule

`default_nettype wire
