// SPDX-License-Identifier: Apache-2.0
// spectral_solver: Poisson solver for one frame after another, by sine transforms along both directions.
//
//   five-point Laplacian of z = f; z = 0 half a pixel outside the frame, or (Neumann) zero slope at its edge, mean zero
//
// Stream in: divergence f in raster order, gaps anywhere, whole frames only. Stream out: depth codes in raster order,
// one burst of Columns words a row. Latency: fixed, in the model. Formats:
// models/tactile_depth/chip/configuration.py.
// Bit-accurate model: models/tactile_depth/chip/poisson/spectral_solver.py.

`default_nettype none

module spectral_solver
  import td_config_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter logic [ConfigBits-1:0] Config = DefaultConfig,
  localparam int Columns          = value(Config, ColumnsField),  // a power of two
  localparam int DataWidth        = value(Config, DataWidthField),  // of a stored word, and of a depth code
  localparam int CoeffWidth       = value(Config, CoeffWidthField),
  localparam int Neumann          = value(Config, NeumannField),  // by cosine transforms
  localparam int RowForwardOut    = value(Config, RowForwardOutField),  // fraction bits dropped on the way
  localparam int ColumnForwardIn  = value(Config, ColumnForwardInField),
  localparam int ColumnInverseOut = value(Config, ColumnInverseOutField),
  localparam int RowInverseIn     = value(Config, RowInverseInField),
  localparam int RowInverseOut    = value(Config, RowInverseOutField),
  localparam int DivideShiftWidth = value(Config, DivideShiftWidthField),
  localparam int DivideDrop       = value(Config, DivideDropField),
  localparam int StoreStyle       = value(Config, StoreStyleField),  // of a frame store, hdl/common/td_ram.sv
  localparam int GradientWidth    = value(Config, GradientWidthField),
  localparam int Parity           = value(Config, ParityField),  // of the memories
  localparam int InWidth          = GradientWidth + 2,  // of a divergence
  localparam int Width            = DataWidth + GuardBits  // of the arithmetic
) (
  input  wire                         clk,
  input  wire                         rst,
  input  wire                         en,
  input  wire                         in_valid,
  input  wire                         in_frame_start,   // the first word of a frame
  input  wire  signed [InWidth-1:0]   in_data,          // divergence, the fraction bits of a slope
  output logic                        out_start,
  output logic                        out_frame_start,  // the first burst of a frame
  output logic signed [DataWidth-1:0] out_data,         // depth code
  output logic [7:0]                  saturations,      // clip count, delayed
  output logic                        flipped           // a word that was read has a flipped bit
);

  localparam int Sine = Neumann != 0 ? 0 : 1;

  logic row_start, row_modes_start, column_start, modes_start, divided_start;
  logic column_out_start, depth_row_start, depth_start;
  logic row_frame_start, row_modes_frame_start, column_frame_start, modes_frame_start, divided_frame_start;
  logic column_out_frame_start, depth_row_frame_start, depth_frame_start;
  logic [InWidth-1:0] row_data;
  logic [DataWidth-1:0] column_data, depth_row_data;
  logic signed [DataWidth-1:0] row_modes, column_out, depth;
  logic signed [Width-1:0] modes, divided;
  logic [7:0] clipped_row_forward, clipped_column_forward, clipped_column_inverse, clipped_row_inverse;
  logic clipped_divide;

  logic [8:0] flips;  // of the cores, in the order of the data
  row_order #(.Width(InWidth), .Columns(Columns), .Paths(1), .Parity(Parity)) u_row_in (
    .clk, .rst, .en, .in_valid, .in_frame_start, .in_data(in_data),
    .out_start(row_start), .out_frame_start(row_frame_start), .out_data(row_data), .flipped(flips[0])
  );

  dst_forward #(
    .TableFolder(TableFolder), .Size(Columns), .Width(Width), .CoeffWidth(CoeffWidth), .Sine(Sine),
    .InWidth(InWidth), .InputDrop(0), .OutWidth(DataWidth), .OutputDrop(RowForwardOut), .Parity(Parity)
  ) u_row_forward (
    .clk, .rst, .en, .in_start(row_start), .in_frame_start(row_frame_start), .in_data(row_data),
    .out_start(row_modes_start), .out_frame_start(row_modes_frame_start), .out_data(row_modes),
    .saturations(clipped_row_forward), .flipped(flips[1])
  );

  transpose #(
    .Width(DataWidth), .Columns(Columns), .MakhoulIn(0), .MakhoulOut(1), .Style(StoreStyle), .Parity(Parity)
  ) u_to_columns (
    .clk, .rst, .en, .in_start(row_modes_start), .in_frame_start(row_modes_frame_start), .in_data(row_modes),
    .out_start(column_start), .out_frame_start(column_frame_start), .out_data(column_data), .flipped(flips[2])
  );

  dst_forward #(
    .TableFolder(TableFolder), .Size(Columns), .Width(Width), .CoeffWidth(CoeffWidth), .Sine(Sine),
    .InWidth(DataWidth), .InputDrop(ColumnForwardIn), .OutWidth(Width), .OutputDrop(0), .Parity(Parity)
  ) u_column_forward (
    .clk, .rst, .en, .in_start(column_start), .in_frame_start(column_frame_start), .in_data(column_data),
    .out_start(modes_start), .out_frame_start(modes_frame_start), .out_data(modes),
    .saturations(clipped_column_forward), .flipped(flips[3])
  );

  spectral_divide #(
    .File({TableFolder, "reciprocal.hex"}), .Width(Width), .CoeffWidth(CoeffWidth), .Columns(Columns),
    .ShiftWidth(DivideShiftWidth), .Drop(DivideDrop), .Parity(Parity)
  ) u_divide (
    .clk, .rst, .en, .in_start(modes_start), .in_frame_start(modes_frame_start), .in_data(modes),
    .out_start(divided_start), .out_frame_start(divided_frame_start), .out_data(divided), .saturations(clipped_divide),
    .flipped(flips[4])
  );

  dst_inverse #(
    .TableFolder(TableFolder), .Size(Columns), .Width(Width), .CoeffWidth(CoeffWidth), .Sine(Sine),
    .InWidth(Width), .InputDrop(0), .OutWidth(DataWidth), .OutputDrop(ColumnInverseOut), .Parity(Parity)
  ) u_column_inverse (
    .clk, .rst, .en, .in_start(divided_start), .in_frame_start(divided_frame_start), .in_alone(1'b1),
    .in_a(divided), .in_b(Width'(0)), .out_start(column_out_start), .out_frame_start(column_out_frame_start),
    .out_alone(), .out_a(column_out), .out_b(), .saturations(clipped_column_inverse), .flipped(flips[5])
  );

  transpose #(
    .Width(DataWidth), .Columns(Columns), .MakhoulIn(1), .MakhoulOut(0), .Style(StoreStyle), .Parity(Parity)
  ) u_to_rows (
    .clk, .rst, .en, .in_start(column_out_start), .in_frame_start(column_out_frame_start), .in_data(column_out),
    .out_start(depth_row_start), .out_frame_start(depth_row_frame_start), .out_data(depth_row_data), .flipped(flips[6])
  );

  dst_inverse #(
    .TableFolder(TableFolder), .Size(Columns), .Width(Width), .CoeffWidth(CoeffWidth), .Sine(Sine),
    .InWidth(DataWidth), .InputDrop(RowInverseIn), .OutWidth(DataWidth), .OutputDrop(RowInverseOut), .Parity(Parity)
  ) u_row_inverse (
    .clk, .rst, .en, .in_start(depth_row_start), .in_frame_start(depth_row_frame_start), .in_alone(1'b1),
    .in_a(depth_row_data), .in_b(DataWidth'(0)), .out_start(depth_start), .out_frame_start(depth_frame_start),
    .out_alone(), .out_a(depth), .out_b(), .saturations(clipped_row_inverse), .flipped(flips[7])
  );

  corner_turn #(.Width(DataWidth), .Size(Columns), .Lanes(1), .Parity(Parity)) u_row_out (
    .clk, .rst, .en, .in_start(depth_start), .in_frame_start(depth_frame_start), .in_alone(1'b1), .in_a(depth),
    .in_b(DataWidth'(0)), .out_start, .out_frame_start, .out_data(out_data), .flipped(flips[8])
  );

  always_ff @(posedge clk) begin
    flipped <= flips != '0;
    saturations <= clipped_row_forward + clipped_column_forward + 8'(clipped_divide) + clipped_column_inverse
        + clipped_row_inverse;
    if (rst) saturations <= '0;
  end

endmodule

`default_nettype wire
