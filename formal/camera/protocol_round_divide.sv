// SPDX-License-Identifier: Apache-2.0
// protocol_round_divide: no weight is 0; the mean counts once 10 enabled clocks have passed.

`default_nettype none

module protocol_round_divide #(
  parameter int WeightWidth = 8
) (
  input  logic                   clk,
  input  logic                   en,
  input  logic [WeightWidth-1:0] weight,
  output logic                   holds,
  output logic                   counts_mean
);

  assign holds = weight != '0;
  settled #(.Clocks(10)) u_settled (.clk, .en, .settled(counts_mean));

endmodule

`default_nettype wire
