// SPDX-License-Identifier: Apache-2.0
// assumed: the inputs of a core are those that its protocol allows, and the first clock is in a reset; `started` is low
// in that clock alone.

`default_nettype none

module assumed (
  input  logic clk,
  input  logic rst,
  input  logic allowed,
  output logic started
);

  logic running = 1'b0;
  assign started = running;
  always_ff @(posedge clk) running <= 1'b1;
  always_comb begin
    assume (allowed);
    if (!running) assume (rst);
  end

endmodule

`default_nettype wire
