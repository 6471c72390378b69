// SPDX-License-Identifier: Apache-2.0
// td_enable: the enable of one unit, in a register of its own: no net goes to every register of the design.
//
// en is the en_next of the clock before, and 0 in the clock after a reset. The attributes keep tools from making one
// register of those of several units. Bit-accurate model: models/tactile_depth/chip/common/td_enable.py.

`default_nettype none

module td_enable (
  input  wire  clk,
  input  wire  rst,
  input  wire  en_next,  // whether the pipeline moves in the next clock
  output logic en
);

  (* dont_touch = "true" *) logic own;
  assign en = own;
  (* keep *) always_ff @(posedge clk) begin
    own <= en_next;
    if (rst) own <= 1'b0;
  end

endmodule

`default_nettype wire
