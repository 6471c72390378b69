// SPDX-License-Identifier: Apache-2.0
// back_substitution: the way up of Thomas's algorithm, all modes of a row in turn.
//
//   z[i] = d[i] - c[i] z[i+1],  z[Rows] = 0
//
// Stream in: bursts of Columns words d, Rows of them a frame, last row first, gaps between bursts anywhere. Stream out:
// the same bursts of z, Width bits. Latency: 8 cycles; en low: nothing moves. z waits in a memory for the row above.
// One multiplier. Bit-accurate model: models/tactile_depth/chip/poisson/back_substitution.py.

`default_nettype none

module back_substitution #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Width        = 27,
  parameter int CoeffWidth   = 18,
  parameter int Rows         = 128,
  parameter int Columns      = 128,
  parameter int InWidth      = 24,
  parameter int Drop         = -3,  // fraction bits from d to z; negative: added
  parameter int TableWords   = 1379,
  parameter int SettledWidth = 7
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire                       in_start,
  input  wire                       in_frame_start,  // with in_start: the first burst of a frame
  input  wire  signed [InWidth-1:0] in_data,         // d, F fraction bits
  output logic                      out_start,
  output logic                      out_frame_start,
  output logic signed [Width-1:0]   out_data,        // z, F - Drop fraction bits
  output logic                      saturations      // clip count, delayed
);

  localparam int PositionWidth = $clog2(Columns);
  localparam int RowWidth = $clog2(Rows);
  localparam int ProductWidth = Width + CoeffWidth;
  localparam int Align = CoeffWidth - 1 - Drop;
  localparam int SumWidth = (InWidth + Align > ProductWidth ? InWidth + Align : ProductWidth) + 1;
  localparam int ToSum = 7;
  localparam int ToBelow = 3;  // cycles to the register before z of the row below

  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row, row_q;
  logic active;
  assign row = in_frame_start ? RowWidth'(Rows - 1) : row_q;
  td_burst_counter #(.Words(Columns)) u_counter (
    .clk, .rst, .en, .start(in_start), .position, .active
  );

  logic signed [CoeffWidth-1:0] coefficient;
  logic unused_shift;
  thomas_table #(
    .TableFolder(TableFolder), .CoeffWidth(CoeffWidth), .Rows(Rows), .Columns(Columns), .Words(TableWords),
    .SettledWidth(SettledWidth), .HasLastRow(1'b0)  // z[Rows] = 0: the last row multiplies nothing
  ) u_table (
    .clk, .en, .position, .row, .coefficient, .shift(unused_shift)
  );

  logic [ToSum:0] active_q;
  logic [ToSum:0][PositionWidth-1:0] position_q;
  logic [ToSum-1:0] start_q, frame_start_q;
  logic [ToSum-2:0][InWidth-1:0] data_q;
  logic signed [Width-1:0] waiting, below_q, below, rounded;
  logic signed [ProductWidth-1:0] product;
  logic signed [SumWidth-1:0] sum;
  logic [ToBelow-1:0] first_q;  // the row is a frame's last: no row is below
  logic clipped;
  td_multiply #(.AWidth(Width), .BWidth(CoeffWidth)) u_product (
    .clk, .en, .a(below), .b(coefficient), .product
  );
  td_round_saturate #(.InWidth(SumWidth), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_round (
    .in(sum), .out(rounded), .clipped
  );
  td_ram #(.Width(Width), .Depth(Columns)) u_row_below (
    .clk,
    .write_en     (en & active_q[ToSum]),
    .write_address(position_q[ToSum]),
    .write_data   (out_data),
    .read_en      (en & active_q[1]),
    .read_address (position_q[1]),
    .read_data    (waiting)
  );

  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= {start_q[ToSum-2:0], in_start};
      frame_start_q <= {frame_start_q[ToSum-2:0], in_frame_start};
      active_q <= {active_q[ToSum-1:0], active};
      position_q <= {position_q[ToSum-1:0], position};
      first_q <= {first_q[ToBelow-2:0], row == RowWidth'(Rows - 1)};
      row_q <= row - RowWidth'(active & (position == PositionWidth'(Columns - 1)));
      data_q <= {data_q[ToSum-3:0], in_data};
      below_q <= first_q[ToBelow-1] ? '0 : waiting;
      below <= below_q;
      sum <= (SumWidth'($signed(data_q[ToSum-2])) <<< Align) - SumWidth'(product);
      out_data <= rounded;
      out_start <= start_q[ToSum-1];
      out_frame_start <= frame_start_q[ToSum-1];
    end
    saturations <= en & active_q[ToSum-1] & clipped;
    if (rst) begin
      start_q <= '0;
      frame_start_q <= '0;
      active_q <= '0;
      out_start <= 1'b0;
      out_frame_start <= 1'b0;
      saturations <= 1'b0;
    end
  end

endmodule

`default_nettype wire
