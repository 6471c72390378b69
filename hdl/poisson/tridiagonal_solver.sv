// SPDX-License-Identifier: Apache-2.0
// tridiagonal_solver: Poisson solver by sine transforms along the rows and Thomas's algorithm down the columns.
//
//   five-point Laplacian of z = f; z = 0 half a pixel outside the frame, or (Neumann) zero slope at its edge, mean zero
//
// Stream in: divergence f in raster order, gaps anywhere, whole frames only. Stream out: depth codes, bottom row first,
// one burst of Columns cycles a row. Latency: fixed, 3.5 Columns and a few registers behind the last pixel; in the
// model. Several depth codes a clock: wide_solver. Formats:
// models/tactile_depth/chip/configuration.py. Bit-accurate model:
// models/tactile_depth/chip/poisson/tridiagonal_solver.py.

`default_nettype none

module tridiagonal_solver
  import td_config_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter logic [ConfigBits-1:0] Config = DefaultConfig,
  localparam int Rows           = value(Config, RowsField),
  localparam int Columns        = value(Config, ColumnsField),  // a power of two
  localparam int DataWidth      = value(Config, DataWidthField),  // of a stored word, and of a depth code
  localparam int CoeffWidth     = value(Config, CoeffWidthField),
  localparam int Neumann        = value(Config, NeumannField),  // by cosine transforms
  localparam int RowForwardOut  = value(Config, RowForwardOutField),  // fraction bits dropped on the way
  localparam int RowInverseIn   = value(Config, RowInverseInField),
  localparam int RowInverseOut  = value(Config, RowInverseOutField),
  localparam int TableWords     = value(Config, TableWordsField),
  localparam int SettledWidth   = value(Config, SettledWidthField),
  localparam int LastShiftWidth = value(Config, LastShiftWidthField),
  localparam int MomentDrop     = value(Config, MomentDropField),
  localparam int MeanReciprocal = value(Config, MeanReciprocalField),
  localparam int MeanDrop       = value(Config, MeanDropField),
  localparam int StoreStyle     = value(Config, StoreStyleField),  // of a frame store, hdl/common/td_ram.sv
  localparam int WordsPerRow    = value(Config, WordsPerRowField),  // of its memory
  localparam int GradientWidth  = value(Config, GradientWidthField),
  localparam int InWidth        = GradientWidth + 2,  // of a divergence
  localparam int Width          = DataWidth + GuardBits  // of the arithmetic
) (
  input  wire                         clk,
  input  wire                         rst,
  input  wire                         en,
  input  wire                         in_valid,
  input  wire                         in_frame_start,   // the first word of a frame
  input  wire  signed [InWidth-1:0]   in_data,          // divergence, the fraction bits of a slope
  output logic                        out_start,
  output logic                        out_frame_start,  // the first burst of a frame
  output logic [DataWidth-1:0]        out_data,         // depth code, signed
  output logic [7:0]                  saturations       // clip count, delayed
);

  localparam int Sine = Neumann != 0 ? 0 : 1;

  logic row_start, modes_start, eliminated_start, row_frame_start, modes_frame_start, eliminated_frame_start;
  logic [InWidth-1:0] row_data;
  logic signed [Width-1:0] modes;
  logic signed [DataWidth-1:0] eliminated;
  logic stacked_start, stacked_frame_start, solved_start, solved_frame_start, depth_start, depth_frame_start;
  logic signed [DataWidth-1:0] stacked, depth;
  logic signed [Width-1:0] solved;
  logic [7:0] clipped_forward, clipped_inverse;
  logic [2:0] clipped_down;
  logic clipped_up;

  row_reorder #(.Width(InWidth), .Columns(Columns), .ToBurst(1)) u_row_in (
    .clk, .rst, .en, .in_valid, .in_frame_start, .in_data(in_data),
    .out_start(row_start), .out_frame_start(row_frame_start), .out_data(row_data)
  );

  dst_forward #(
    .TableFolder(TableFolder), .Size(Columns), .Width(Width), .CoeffWidth(CoeffWidth), .Sine(Sine),
    .InWidth(InWidth), .InputDrop(0), .OutWidth(Width), .OutputDrop(RowForwardOut)
  ) u_row_forward (
    .clk, .rst, .en, .in_start(row_start), .in_frame_start(row_frame_start), .in_data(row_data),
    .out_start(modes_start), .out_frame_start(modes_frame_start), .out_data(modes), .saturations(clipped_forward)
  );

  forward_elimination #(
    .TableFolder(TableFolder), .Width(Width), .CoeffWidth(CoeffWidth), .Rows(Rows), .Columns(Columns),
    .StoreDrop(GuardBits), .OutWidth(DataWidth), .Neumann(Neumann), .TableWords(TableWords),
    .SettledWidth(SettledWidth), .LastShiftWidth(LastShiftWidth), .MomentDrop(MomentDrop),
    .MeanReciprocal(MeanReciprocal), .MeanDrop(MeanDrop)
  ) u_down (
    .clk, .rst, .en, .in_start(modes_start), .in_frame_start(modes_frame_start), .in_data(modes),
    .out_start(eliminated_start), .out_frame_start(eliminated_frame_start), .out_data(eliminated),
    .saturations(clipped_down)
  );

  frame_stack #(
    .Width(DataWidth), .Rows(Rows), .Columns(Columns), .WordsPerRow(WordsPerRow), .Style(StoreStyle)
  ) u_stack (
    .clk, .rst, .en, .in_start(eliminated_start), .in_frame_start(eliminated_frame_start), .in_data(eliminated),
    .out_start(stacked_start), .out_frame_start(stacked_frame_start), .out_data(stacked)
  );

  back_substitution #(
    .TableFolder(TableFolder), .Width(Width), .CoeffWidth(CoeffWidth), .Rows(Rows), .Columns(Columns),
    .InWidth(DataWidth), .Drop(-GuardBits), .TableWords(TableWords), .SettledWidth(SettledWidth)
  ) u_up (
    .clk, .rst, .en, .in_start(stacked_start), .in_frame_start(stacked_frame_start), .in_data(stacked),
    .out_start(solved_start), .out_frame_start(solved_frame_start), .out_data(solved), .saturations(clipped_up)
  );

  dst_inverse #(
    .TableFolder(TableFolder), .Size(Columns), .Width(Width), .CoeffWidth(CoeffWidth), .Sine(Sine),
    .InWidth(Width), .InputDrop(RowInverseIn), .OutWidth(DataWidth), .OutputDrop(RowInverseOut)
  ) u_row_inverse (
    .clk, .rst, .en, .in_start(solved_start), .in_frame_start(solved_frame_start), .in_data(solved),
    .out_start(depth_start), .out_frame_start(depth_frame_start), .out_data(depth), .saturations(clipped_inverse)
  );

  logic depth_valid;
  logic [$clog2(Columns)-1:0] unused_position;
  td_burst_counter #(.Words(Columns)) u_depth_valid (
    .clk, .rst, .en, .start(depth_start), .position(unused_position), .active(depth_valid)
  );
  row_reorder #(.Width(DataWidth), .Columns(Columns), .ToBurst(0)) u_row_out (
    .clk, .rst, .en, .in_valid(depth_valid), .in_frame_start(depth_frame_start), .in_data(depth),
    .out_start, .out_frame_start, .out_data
  );

  always_ff @(posedge clk) begin
    saturations <= clipped_forward + 8'(clipped_down) + 8'(clipped_up) + clipped_inverse;
    if (rst) saturations <= '0;
  end

endmodule

`default_nettype wire
