// SPDX-License-Identifier: Apache-2.0
// protocol_td_ramp: any words and steps; what leaves counts once log2(Count) enabled clocks have passed.

`default_nettype none

module protocol_td_ramp #(
  parameter int Count = 4
) (
  input  logic clk,
  input  logic en,
  output logic counts_out
);

  if (Count > 1) begin : g_levels
    settled #(.Clocks($clog2(Count))) u_settled (.clk, .en, .settled(counts_out));
  end else begin : g_at_once
    logic unused_clock;
    assign unused_clock = clk & en;
    assign counts_out = 1'b1;
  end

endmodule

`default_nettype wire
