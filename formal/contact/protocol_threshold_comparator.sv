// SPDX-License-Identifier: Apache-2.0
// protocol_threshold_comparator: the first depth after a reset is the first of a frame.

`default_nettype none

module protocol_threshold_comparator (
  input  logic clk,
  input  logic rst,
  input  logic in_valid,
  input  logic in_frame_start,
  output logic holds,
  output logic counts_contact
);

  logic reset, live = 1'b0, begun = 1'b0;
  assign reset = rst | ~holds;
  assign holds = ~in_valid | rst | begun | in_frame_start;
  assign counts_contact = live & ~reset;
  always_ff @(posedge clk) begin
    live <= live | reset;
    begun <= ~reset & (begun | (in_valid & in_frame_start));
  end

endmodule

`default_nettype wire
