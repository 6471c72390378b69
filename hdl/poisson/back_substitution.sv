// SPDX-License-Identifier: Apache-2.0
// back_substitution: the way up of Thomas's algorithm, all modes of a row in turn, one or more rows at a time.
//
//   z[i] = d[i] - c[i] z[i+1],  z[Rows] = 0
//
// Stream in: bursts of Columns words d, Rows of them a frame, last row first, to the lanes in turn; with more than one,
// each row Columns / Lanes cycles after the row before. Stream out: the same bursts of z, Width bits. Latency: 8
// cycles; en low: nothing moves. The lanes are a ring: each takes z of the row below from the lane before it, the first
// from the last. z waits in a memory; where a row is 4 cycles behind the row before, it goes straight into the next
// product. One multiplier for each lane. Bit-accurate model: models/tactile_depth/poisson/back_substitution.py.

`default_nettype none

module back_substitution #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Width        = 27,
  parameter int CoeffWidth   = 18,
  parameter int Rows         = 128,
  parameter int Columns      = 128,
  parameter int Lanes        = 1,
  parameter int InWidth      = 24,
  parameter int Drop         = -3,  // fraction bits from d to z; negative: added
  parameter int TableWords   = 1379,
  parameter int SettledWidth = 7,
  localparam int ClippedWidth = $clog2(Lanes + 1)
) (
  input  wire                      clk,
  input  wire                      rst,
  input  wire                      en,
  input  wire  [Lanes-1:0]         in_start,
  input  wire  [Lanes-1:0]         in_frame_start,  // with in_start: the first burst of a frame in this lane
  input  wire  [Lanes*InWidth-1:0] in_data,         // d for each lane, F fraction bits
  output logic [Lanes-1:0]         out_start,
  output logic [Lanes-1:0]         out_frame_start,
  output logic [Lanes*Width-1:0]   out_data,        // z for each lane, F - Drop fraction bits
  output logic [ClippedWidth-1:0]  saturations      // clip count, delayed
);

  localparam int PositionWidth = $clog2(Columns);
  localparam int RowWidth = $clog2(Rows);
  localparam int Step = Columns / Lanes;  // cycles from a row to the row above
  localparam int StepWidth = $clog2(Step);
  localparam int ProductWidth = Width + CoeffWidth;
  localparam int Align = CoeffWidth - 1 - Drop;
  localparam int SumWidth = (InWidth + Align > ProductWidth ? InWidth + Align : ProductWidth) + 1;
  localparam int ToSum = 7;
  localparam int Direct = 4;  // cycles from the product with z of the row below to z
  localparam int ToBelow = Step == Direct ? 4 : 3;  // cycles to z of the row below, or to the register before it

  logic [Lanes-1:0] clipped_q;

  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    localparam int Before = (lane + Lanes - 1) % Lanes;

    logic [PositionWidth-1:0] position;
    logic [RowWidth-1:0] row, row_q;
    logic active;
    assign row = in_frame_start[lane] ? RowWidth'(Rows - 1 - lane) : row_q;
    td_burst_counter #(.Words(Columns)) u_counter (
      .clk, .rst, .en, .start(in_start[lane]), .position, .active
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
    logic [ToSum-1:0] start_q, frame_start_q;
    logic [ToSum-2:0][InWidth-1:0] data_q;
    logic signed [Width-1:0] below, rounded;
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

    always_ff @(posedge clk) begin
      if (en) begin
        start_q <= {start_q[ToSum-2:0], in_start[lane]};
        frame_start_q <= {frame_start_q[ToSum-2:0], in_frame_start[lane]};
        active_q <= {active_q[ToSum-1:0], active};
        first_q <= {first_q[ToBelow-2:0], lane == 0 && row == RowWidth'(Rows - 1)};
        row_q <= row - (active && position == PositionWidth'(Columns - 1) ? RowWidth'(Lanes) : '0);
        data_q <= {data_q[ToSum-3:0], in_data[lane*InWidth+:InWidth]};
        sum <= (SumWidth'($signed(data_q[ToSum-2])) <<< Align) - SumWidth'(product);
        out_data[lane*Width+:Width] <= rounded;
        out_start[lane] <= start_q[ToSum-1];
        out_frame_start[lane] <= frame_start_q[ToSum-1];
      end
      clipped_q[lane] <= en & active_q[ToSum-1] & clipped;
      if (rst) begin
        start_q <= '0;
        frame_start_q <= '0;
        active_q <= '0;
        out_start[lane] <= 1'b0;
        out_frame_start[lane] <= 1'b0;
        clipped_q[lane] <= 1'b0;
      end
    end

    // z of the row below, out of the lane before.
    if (Step == Direct) begin : g_direct
      always_ff @(posedge clk) if (en) below <= first_q[ToBelow-1] ? '0 : out_data[Before*Width+:Width];
    end else begin : g_waits
      // A word is read before the next one is written over it, Step cycles later.
      logic [ToSum:0][StepWidth-1:0] position_q;  // in the row of words that are below
      logic signed [Width-1:0] waiting, below_q;
      td_ram #(.Width(Width), .Depth(Step)) u_row_below (
        .clk,
        .write_en     (en & g_lane[Before].active_q[ToSum]),
        .write_address(g_lane[Before].g_waits.position_q[ToSum]),
        .write_data   (out_data[Before*Width+:Width]),
        .read_en      (en & active_q[1]),
        .read_address (position_q[1]),
        .read_data    (waiting)
      );
      always_ff @(posedge clk) begin
        if (en) begin
          position_q <= {position_q[ToSum-1:0], position[StepWidth-1:0]};
          below_q <= first_q[ToBelow-1] ? '0 : waiting;
          below <= below_q;
        end
      end
    end
  end

  always_comb begin
    saturations = '0;
    for (int lane = 0; lane < Lanes; lane++) saturations = saturations + ClippedWidth'(clipped_q[lane]);
  end

  if (Lanes < 1 || Lanes != (1 << $clog2(Lanes)) || (Lanes > 1 && Columns / Lanes < Direct)) begin : g_refused
    Lanes_must_be_a_power_of_two_and_at_most_Columns_by_4 u_refused ();
  end

endmodule

`default_nettype wire
