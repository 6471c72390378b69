// SPDX-License-Identifier: Apache-2.0
// protocol_black_level: after a reset the first pixel begins a frame; samples, marks and gains count with out_valid.

`default_nettype none

module protocol_black_level (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic in_valid,
  input  logic in_frame_start,
  input  logic out_valid,
  output logic holds,
  output logic counts_out_samples,
  output logic counts_out_colour,
  output logic counts_out_row_start,
  output logic counts_out_frame_start,
  output logic counts_out_gains,
  output logic counts
);

  logic reset, live = 1'b0, in_frame = 1'b0, pixel;
  assign reset = rst | ~holds;
  assign holds = rst | ~in_valid | in_frame | in_frame_start;
  always_ff @(posedge clk) begin
    live <= live | reset;
    in_frame <= ~reset & (in_frame | (en & in_valid));
  end
  assign counts = live & ~reset;
  assign pixel = counts & out_valid;
  assign {counts_out_samples, counts_out_colour, counts_out_row_start, counts_out_frame_start} = {4{pixel}};
  assign counts_out_gains = pixel;

endmodule

`default_nettype wire
