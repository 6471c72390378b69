// SPDX-License-Identifier: Apache-2.0
// protocol_block_totals: whole rows of Columns blocks, of any number, from a frame's start on, in a reset
// too; totals count with out_valid.

`default_nettype none

module protocol_block_totals #(
  parameter int Columns   = 128,
  parameter int Numerator = 15,
  localparam int BlockWidth = $clog2(Numerator + 1)
) (
  input  logic                  clk,
  input  logic                  rst,
  input  logic                  en,
  input  logic                  in_row_start,
  input  logic                  in_frame_start,
  input  logic                  in_blue_row,
  input  logic                  in_ends,
  input  logic [BlockWidth-1:0] in_red_columns,
  input  logic                  out_valid,
  output logic [7:0]            column,  // blocks of the row that have ended
  output logic                  holds,
  output logic                  counts_out_valid,
  output logic                  counts_out_totals,
  output logic                  counts_out_areas
);

  logic reset, live = 1'b0, in_frame = 1'b0, blue_row = 1'b0, starts_right, stays_right;
  logic [7:0] ended = '0;
  assign column = in_row_start ? '0 : ended;
  assign starts_right = in_row_start ? in_frame_start | (in_frame & ended == 8'(Columns)) : ~in_frame_start;
  assign stays_right = (~in_ends | ((in_frame | in_row_start) & column != 8'(Columns)))
      & (in_row_start | in_blue_row == blue_row);
  assign holds = starts_right & stays_right & 32'(in_red_columns) <= Numerator;
  assign reset = rst | ~holds;
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (en) begin
      ended <= column + 8'(in_ends);
      blue_row <= in_blue_row;
    end
    in_frame <= ~reset & (in_frame | (en & in_row_start));
    if (reset) ended <= '0;
  end
  assign counts_out_valid = live & ~reset;
  assign {counts_out_totals, counts_out_areas} = {2{counts_out_valid & out_valid}};

endmodule

`default_nettype wire
