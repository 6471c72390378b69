// SPDX-License-Identifier: Apache-2.0
// axis_source: an offer stays until it is taken; there is none in reset and in the clock after it.

`default_nettype none

module axis_source #(
  parameter int Width = 26
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             reset,
  input  logic             valid,
  input  logic             ready,
  input  logic [Width-1:0] word,
  output logic             holds
);

  logic was_reset = 1'b1, stays;
  always_ff @(posedge clk) was_reset <= reset;
  offer_stays #(.Width(Width)) u_offer (.clk, .rst, .reset, .valid, .ready, .word, .holds(stays));
  assign holds = stays & ~(valid & (rst | was_reset));

endmodule

`default_nettype wire
