// SPDX-License-Identifier: Apache-2.0
// protocol_wide_row_pairs: two rows a burst, 2 enabled clocks behind their start.

`default_nettype none

module protocol_wide_row_pairs #(
  parameter int Size  = 8,
  parameter int Paths = 2
) (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic in_start,
  input  logic in_frame_start,
  input  logic out_start,
  output logic holds,
  output logic counts_out_start,
  output logic counts_out_frame_start,
  output logic counts_saturations,
  output logic counts
);

  protocol_wide_bursts #(.Beats(Size / Paths), .OutBeats(Size / Paths), .OutLead(2)) u_bursts (.*);

endmodule

`default_nettype wire
