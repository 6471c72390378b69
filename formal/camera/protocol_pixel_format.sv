// SPDX-License-Identifier: Apache-2.0
// protocol_pixel_format: pixels of YUYV come in pairs, a break without a pixel; any others. Samples and marks count with
// out_valid, the colour of a pixel in RAW formats alone.

`default_nettype none

module protocol_pixel_format
  import td_camera_map_pkg::*;
#(
  parameter int Format = 0
) (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic in_valid,
  input  logic in_odd_column,
  input  logic in_abort,
  input  logic out_valid,
  output logic holds,
  output logic counts_out_samples,
  output logic counts_out_colour,
  output logic counts_out_row_start,
  output logic counts_out_frame_start,
  output logic counts
);

  logic reset, live = 1'b0, expects_odd = 1'b0, pixel;
  assign reset = rst | ~holds;
  assign holds = rst | ~in_valid | format_is_yuyv(Format) == 0 | (~in_abort & in_odd_column == expects_odd);
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (en && (in_valid || in_abort)) expects_odd <= in_valid & ~in_odd_column;
    if (reset) expects_odd <= 1'b0;
  end
  assign counts = live & ~reset;
  assign pixel = counts & out_valid;
  assign {counts_out_samples, counts_out_row_start, counts_out_frame_start} = {3{pixel}};
  assign counts_out_colour = pixel & (format_is_bayer(Format) != 0);

endmodule

`default_nettype wire
