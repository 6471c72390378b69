// SPDX-License-Identifier: Apache-2.0
// offer_stays: a word that was offered and not taken is offered again, unchanged.

`default_nettype none

module offer_stays #(
  parameter int Width = 8
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             reset,
  input  logic             valid,
  input  logic             ready,
  input  logic [Width-1:0] word,
  output logic             holds
);

  logic waits = 1'b0;
  logic [Width-1:0] waiting;
  always_ff @(posedge clk) begin
    waits <= valid & ~ready & ~reset;
    waiting <= word;
  end
  assign holds = ~waits | rst | (valid && word == waiting);

endmodule

`default_nettype wire
