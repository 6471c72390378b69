// SPDX-License-Identifier: Apache-2.0
// protocol_light_gains: whole frames in raster order, cut short by a reset alone.

`default_nettype none

module protocol_light_gains #(
  parameter int Rows    = 128,
  parameter int Columns = 128
) (
  input  logic        clk,
  input  logic        rst,
  input  logic        en,
  input  logic        in_valid,
  input  logic        out_valid,
  output logic [15:0] row,
  output logic [15:0] column,
  output logic [3:0]  given_in_position,
  output logic        counts_gains,
  output logic        counts_out_valid,
  output logic        counts_out_position,
  output logic        counts_out_red,
  output logic        counts_out_green,
  output logic        counts_out_blue,
  output logic        counts_saturations
);

  logic live = 1'b0;
  logic [3:0] place;
  always_ff @(posedge clk) live <= live | rst;
  raster_places #(.Rows(Rows), .Columns(Columns)) u_places (.*, .reset(rst));
  assign given_in_position = place;
  assign counts_gains = live;
  assign counts_saturations = live & ~rst;
  assign counts_out_valid = live & ~rst & en;
  assign {counts_out_position, counts_out_red, counts_out_green, counts_out_blue} = {4{counts_out_valid & out_valid}};

endmodule

`default_nettype wire
