// SPDX-License-Identifier: Apache-2.0
// kept: outputs stand while en is low; `held`: the clock before had neither an enable nor a reset.

`default_nettype none

module kept #(
  parameter int Width = 1
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic [Width-1:0] out,
  output logic             held
);

  logic still = 1'b0;
  logic [Width-1:0] out_q;
  assign held = still;
  always_ff @(posedge clk) begin
    still <= ~en & ~rst;
    out_q <= out;
  end
  always_comb if (still) stays: assert (out == out_q);

endmodule

`default_nettype wire
