// SPDX-License-Identifier: Apache-2.0
// back_substitution: the way up of Thomas's algorithm, all modes of a row in turn.
//
//   z[i] = d[i] - c[i] z[i+1],  z[Rows] = 0
//
// Stream in: bursts of Size words d, Rows of them a frame, last row first. Stream out: the same bursts of z, Width
// bits. Latency: 8 cycles. One multiplier. Bit-accurate model: models/tactile_depth/poisson/back_substitution.py.

module back_substitution #(
  parameter int Width          = 27,
  parameter int CoeffWidth     = 18,
  parameter int Rows           = 128,
  parameter int Size           = 128,
  parameter int InWidth        = 24,
  parameter int Lift           = 3,  // fraction bits of z beyond those of d
  parameter int TableWords     = 1379,
  parameter int SettledWidth   = 7,
  parameter int LastShiftWidth = 1
) (
  input  logic                      clk,
  input  logic                      rst,
  input  logic                      en,
  input  logic                      in_start,
  input  logic                      in_frame_start,   // with in_start: the first burst of a frame
  input  logic signed [InWidth-1:0] in_data,
  output logic                      out_start,
  output logic                      out_frame_start,
  output logic signed [Width-1:0]   out_data,
  output logic                      saturations  // values clipped in a cycle
);

  localparam int PositionWidth = $clog2(Size);
  localparam int RowWidth = $clog2(Rows);
  localparam int ProductWidth = Width + CoeffWidth;
  localparam int Align = Lift + CoeffWidth - 1;
  localparam int SumWidth = (InWidth + Align > ProductWidth ? InWidth + Align : ProductWidth) + 1;
  localparam int ToSum = 7;

  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row, row_q;
  logic active;
  assign row = in_frame_start ? RowWidth'(Rows - 1) : row_q;
  burst_counter #(.Size(Size)) u_counter (
    .clk, .rst, .en, .start(in_start), .position, .active
  );

  logic signed [CoeffWidth-1:0] coefficient;
  logic [LastShiftWidth-1:0] unused_shift;
  thomas_table #(
    .CoeffWidth(CoeffWidth), .Rows(Rows), .Size(Size), .Words(TableWords),
    .SettledWidth(SettledWidth), .LastShiftWidth(LastShiftWidth)
  ) u_table (
    .clk, .en, .position, .row, .coefficient, .shift(unused_shift)
  );

  logic [ToSum:0] active_q;
  logic [ToSum-1:0] start_q, frame_start_q;
  logic [(ToSum+1)*PositionWidth-1:0] position_q;
  logic signed [InWidth-1:0] data_q, data_q2, data_q3, data_q4, data_q5, data_q6;
  logic signed [Width-1:0] below, below_q2, below_q3, rounded;
  logic signed [ProductWidth-1:0] product;
  logic signed [SumWidth-1:0] sum;
  logic first_q, first_q2, first_q3, clipped;
  multiply #(.AWidth(Width), .BWidth(CoeffWidth)) u_product (
    .clk, .en, .a(below_q3), .b(coefficient), .product
  );
  round_saturate #(.InWidth(SumWidth), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_round (
    .in(sum), .out(rounded), .clipped
  );

  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= {start_q[ToSum-2:0], in_start};
      frame_start_q <= {frame_start_q[ToSum-2:0], in_frame_start};
      active_q <= {active_q[ToSum-1:0], active};
      position_q <= {position_q[ToSum*PositionWidth-1:0], position};
      first_q <= row == RowWidth'(Rows - 1);
      first_q2 <= first_q;
      first_q3 <= first_q2;
      row_q <= row - RowWidth'(active & (position == PositionWidth'(Size - 1)));
      data_q <= in_data;
      data_q2 <= data_q;
      data_q3 <= data_q2;
      data_q4 <= data_q3;
      data_q5 <= data_q4;
      data_q6 <= data_q5;
      below_q2 <= first_q3 ? '0 : below;
      below_q3 <= below_q2;
      sum <= (SumWidth'(data_q6) <<< Align) - SumWidth'(product);
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

  ram #(
    .Width(Width),
    .Depth(Size),
    .Style((Width * Size > 4096) ? 1 : 0)
  ) u_row_below (
    .clk,
    .write_en     (en & active_q[ToSum]),
    .write_address(position_q[ToSum*PositionWidth+:PositionWidth]),
    .write_data   (out_data),
    .read_en      (en & active_q[1]),
    .read_address (position_q[PositionWidth+:PositionWidth]),
    .read_data    (below)
  );

endmodule
