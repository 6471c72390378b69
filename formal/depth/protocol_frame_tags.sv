// SPDX-License-Identifier: Apache-2.0
// protocol_frame_tags: frames end at least Pixels enabled clocks apart.

`default_nettype none

module protocol_frame_tags #(
  parameter int Pixels = 16384,
  localparam int CountWidth = $clog2(Pixels + 1)
) (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic push,
  output logic holds,
  output logic counts
);

  logic reset, live = 1'b0;
  logic [CountWidth-1:0] left = '0;  // enabled clocks until the next push may come
  assign reset = rst | ~holds;
  assign holds = ~push | rst | left == '0;
  assign counts = live;
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (reset) left <= '0;
    else if (en) left <= push ? CountWidth'(Pixels - 1) : left - CountWidth'(left != '0);
  end

endmodule

`default_nettype wire
