// SPDX-License-Identifier: Apache-2.0
// protocol_contact_sums: frames as depth_frames allows them; sums count while they are valid, the limits where there is an
// area.

`default_nettype none

module protocol_contact_sums #(
  parameter int Rows    = 128,
  parameter int Columns = 128,
  parameter int Lanes   = 1,   // depths in a beat
  localparam int PlaceWidth = $clog2(Rows * Columns / Lanes)
) (
  input  logic                  clk,
  input  logic                  rst,
  input  logic                  in_valid,
  input  logic [2:0]            in_position,
  input  logic                  sums_valid,
  output logic [PlaceWidth-1:0] place,  // of the beat in its frame
  output logic                  holds,
  output logic                  counts_sums,
  output logic                  counts
);

  logic reset;
  assign counts_sums = counts & sums_valid;
  depth_frames #(.Rows(Rows), .Columns(Columns / Lanes)) u_frames (.*);

endmodule

`default_nettype wire
