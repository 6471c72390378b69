// SPDX-License-Identifier: Apache-2.0
// raster_source: assumes that positions come in raster order, whole frames but for a reset; says where a pixel is.

`default_nettype none

module raster_source #(
  parameter int Rows    = 4,
  parameter int Columns = 4
) (
  input  logic       clk,
  input  logic       rst,
  input  logic       en,
  input  logic       in_valid,
  input  logic [3:0] in_position,
  output logic [3:0] row,
  output logic [3:0] column
);

  logic [3:0] position;
  raster_counter #(.Rows(Rows), .Columns(Columns)) u_counter (.clk, .rst, .en, .in_valid, .row, .column, .position);
  always_comb if (in_valid) assume (in_position == position);

endmodule

`default_nettype wire
