// SPDX-License-Identifier: Apache-2.0
// forward_elimination: the way down of Thomas's algorithm, all modes of a row in turn.
//
//   d[i] = c[i] (f[i] - d[i-1]),  d[-1] = 0
//   Neumann: the column of position 0 is singular; its last row is minus the mean sum over i of (i + 1) d[i] / Rows,
//   which gives it zero mean after the substitution.
//
// Stream in: bursts of Columns modes, Rows of them a frame, gaps between bursts anywhere. Stream out: the same bursts
// of d, rounded to the stored word. Latency: 9 cycles. The running row keeps Width bits. One multiplier, with Neumann
// two more for the mean; between dependent values lie at least Columns cycles, so it pipelines freely. Bit-accurate
// model: models/tactile_depth/chip/poisson/forward_elimination.py.

`default_nettype none

module forward_elimination #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Width          = 27,
  parameter int CoeffWidth     = 18,
  parameter int Rows           = 128,
  parameter int Columns        = 128,
  parameter int StoreDrop      = 3,  // fraction bits dropped on the way out
  parameter int OutWidth       = 24,
  parameter int Neumann        = 0,
  parameter int TableWords     = 1379,
  parameter int SettledWidth   = 7,
  parameter int LastShiftWidth = 1,
  parameter int MomentDrop     = 7,  // Neumann: of the mean
  parameter int MeanReciprocal = 65536,
  parameter int MeanDrop       = 16
) (
  input  wire                        clk,
  input  wire                        rst,
  input  wire                        en,
  input  wire                        in_start,
  input  wire                        in_frame_start,  // with in_start: the first burst of a frame
  input  wire  signed [Width-1:0]    in_data,         // mode f, F fraction bits
  output logic                       out_start,
  output logic                       out_frame_start,
  output logic signed [OutWidth-1:0] out_data,        // d, F - StoreDrop fraction bits
  output logic [2:0]                 saturations      // clip count, delayed
);

  localparam int PositionWidth = $clog2(Columns);
  localparam int RowWidth = $clog2(Rows);
  localparam int ProductWidth = Width + CoeffWidth;
  localparam int ShiftedWidth = ProductWidth + (1 << LastShiftWidth) - 1;
  localparam int ToState = 8;

  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row, row_q;
  logic active;
  assign row = in_frame_start ? '0 : row_q;
  td_burst_counter #(.Words(Columns)) u_counter (
    .clk, .rst, .en, .start(in_start), .position, .active
  );

  logic signed [CoeffWidth-1:0] coefficient;
  logic [LastShiftWidth-1:0] shift, shift_q;
  thomas_table #(
    .TableFolder(TableFolder), .CoeffWidth(CoeffWidth), .Rows(Rows), .Columns(Columns), .Words(TableWords),
    .SettledWidth(SettledWidth), .LastShiftWidth(LastShiftWidth)
  ) u_table (
    .clk, .en, .position, .row, .coefficient, .shift
  );

  // What follows a word down the pipeline.
  logic [ToState-1:0] start_q, frame_start_q, active_q, singular_q;  // singular: position 0 of the last row
  logic [ToState-1:0][PositionWidth-1:0] position_q;
  logic [1:0] first_row_q;
  logic [2:0][Width-1:0] data_q;
  logic signed [Width-1:0] state, above;  // d of the row before
  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= {start_q[ToState-2:0], in_start};
      frame_start_q <= {frame_start_q[ToState-2:0], in_frame_start};
      active_q <= {active_q[ToState-2:0], active};
      singular_q <= {singular_q[ToState-2:0], in_start & (row == RowWidth'(Rows - 1))};
      position_q <= {position_q[ToState-2:0], position};
      first_row_q <= {first_row_q[0], row == '0};
      above <= first_row_q[1] ? '0 : state;
      data_q <= {data_q[1:0], in_data};
      row_q <= row + RowWidth'(active & (position == PositionWidth'(Columns - 1)));
    end
    if (rst) begin
      start_q <= '0;
      frame_start_q <= '0;
      active_q <= '0;
    end
  end

  // Difference, product, shift, rounding.
  logic [1:0][Width-1:0] difference_q;
  logic signed [Width-1:0] difference, rounded, d;
  logic signed [ProductWidth-1:0] product;
  logic signed [ShiftedWidth-1:0] shifted;
  logic [Width-1:0] last_mean;  // of the singular column, in its last row, whose product is 0; else 0
  logic [2:0] clipped, clipped_q;
  td_multiply #(.AWidth(Width), .BWidth(CoeffWidth)) u_product (
    .clk, .en, .a(difference_q[1]), .b(coefficient), .product
  );
  td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_difference (
    .in((Width + 1)'($signed(data_q[2])) - (Width + 1)'(above)), .out(difference), .clipped(clipped[0])
  );
  td_round_saturate #(.InWidth(ShiftedWidth), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_state (
    .in(shifted), .out(rounded), .clipped(clipped[1])
  );
  logic signed [OutWidth-1:0] stored;
  td_round_saturate #(.InWidth(Width), .Drop(StoreDrop), .OutWidth(OutWidth)) u_store (
    .in(d), .out(stored), .clipped(clipped[2])
  );
  always_ff @(posedge clk) begin
    if (en) begin
      difference_q <= {difference_q[0], difference};
      shift_q <= shift;
      shifted <= ShiftedWidth'(product) <<< shift_q | ShiftedWidth'($signed(last_mean)) <<< (CoeffWidth - 1);
      d <= rounded;
      out_data <= stored;
      out_start <= start_q[ToState-1];
      out_frame_start <= frame_start_q[ToState-1];
    end
    clipped_q <= {
      en & active_q[ToState-1] & clipped[2], en & active_q[ToState-2] & clipped[1], en & active_q[2] & clipped[0]
    };
    if (rst) begin
      out_start <= 1'b0;
      out_frame_start <= 1'b0;
      clipped_q <= '0;
    end
  end

  td_ram #(.Width(Width), .Depth(Columns)) u_state_row (
    .clk,
    .write_en     (en & active_q[ToState-1]),
    .write_address(position_q[ToState-1]),
    .write_data   (d),
    .read_en      (en & active_q[0]),
    .read_address (position_q[0]),
    .read_data    (state)
  );

  logic [1:0] clipped_mean;
  if (Neumann != 0) begin : g_mean
    logic signed [Width-1:0] mean;
    column_mean #(
      .Width(Width), .CoeffWidth(CoeffWidth), .Rows(Rows), .MomentDrop(MomentDrop), .MeanReciprocal(MeanReciprocal),
      .MeanDrop(MeanDrop)
    ) u_mean (
      .clk, .rst, .en, .in_next(start_q[ToState-2]), .in_frame_start(frame_start_q[ToState-2]), .in_data(d), .mean,
      .clipped(clipped_mean)
    );
    always_ff @(posedge clk) if (en) last_mean <= singular_q[ToState-4] ? mean : '0;
  end else begin : g_no_mean
    assign last_mean = '0;
    assign clipped_mean = '0;
    logic unused_singular;
    assign unused_singular = ^singular_q;
  end

  always_ff @(posedge clk) begin
    saturations <= 3'(clipped_q[0]) + 3'(clipped_q[1]) + 3'(clipped_q[2]) + 3'(clipped_mean[0]) + 3'(clipped_mean[1]);
    if (rst) saturations <= '0;
  end

endmodule

`default_nettype wire
