// SPDX-License-Identifier: Apache-2.0
// protocol_contact_peak: frames as depth_frames allows them; count and peak count while they are valid.

`default_nettype none

module protocol_contact_peak #(
  parameter int Rows    = 128,
  parameter int Columns = 128,
  parameter int Lanes   = 1,   // depths in a beat
  localparam int PlaceWidth = $clog2(Rows * Columns / Lanes)
) (
  input  logic                  clk,
  input  logic                  rst,
  input  logic                  in_valid,
  input  logic [2:0]            in_position,
  input  logic                  count_valid,
  input  logic                  peak_valid,
  output logic [PlaceWidth-1:0] place,  // of the beat in its frame
  output logic                  holds,
  output logic                  counts_count,
  output logic                  counts_any_above,
  output logic                  counts_peak,
  output logic                  counts_peak_row,
  output logic                  counts_peak_column,
  output logic                  counts
);

  logic reset;
  assign counts_count = counts & count_valid;
  assign {counts_any_above, counts_peak, counts_peak_row, counts_peak_column} = {4{counts & peak_valid}};
  depth_frames #(.Rows(Rows), .Columns(Columns / Lanes)) u_frames (.*);

endmodule

`default_nettype wire
