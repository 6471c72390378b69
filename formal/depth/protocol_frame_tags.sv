// SPDX-License-Identifier: Apache-2.0
// protocol_frame_tags: frames end at least Pixels enabled clocks apart; a push stays while en is low.

`default_nettype none

module protocol_frame_tags #(
  parameter int Pixels = 16384
) (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic push,
  output logic holds,
  output logic counts
);

  logic reset, live = 1'b0, still = 1'b0, push_before;
  logic [15:0] since = '0;  // the last push; 0: none after the reset
  assign reset = rst | ~holds;
  assign holds = (~push | rst | since == '0 | since == 16'(Pixels)) & (~still | rst | push == push_before);
  assign counts = live;
  always_ff @(posedge clk) begin
    live <= live | reset;
    still <= ~en & ~reset;
    push_before <= push;
    if (reset) since <= '0;
    else if (en) since <= push ? 16'd1 : since + 16'(since != '0 && since != 16'(Pixels));
  end

endmodule

`default_nettype wire
