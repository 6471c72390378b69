// SPDX-License-Identifier: Apache-2.0
// protocol_td_delay_line: any inputs; out counts once Delay words came in after a reset.

`default_nettype none

module protocol_td_delay_line #(
  parameter int Delay = 64
) (
  input  logic clk,
  input  logic rst,
  input  logic en,
  output logic counts_out
);

  logic live = 1'b0;
  logic [7:0] words = '0;
  assign counts_out = words == 8'(Delay) & ~rst;
  always_ff @(posedge clk) begin
    live <= live | rst;
    words <= rst ? '0 : words + 8'(en & live & words != 8'(Delay));
  end

endmodule

`default_nettype wire
