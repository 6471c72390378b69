// SPDX-License-Identifier: Apache-2.0
// protocol_contact_debounce: any inputs; began and ended count once there was a frame.

`default_nettype none

module protocol_contact_debounce (
  input  logic clk,
  input  logic rst,
  input  logic area_valid,
  output logic counts_began,
  output logic counts_ended,
  output logic counts
);

  logic live = 1'b0, decided = 1'b0;
  assign counts = live & ~rst;
  assign {counts_began, counts_ended} = {2{counts & decided}};
  always_ff @(posedge clk) begin
    live <= live | rst;
    decided <= ~rst & (decided | area_valid);
  end

endmodule

`default_nettype wire
