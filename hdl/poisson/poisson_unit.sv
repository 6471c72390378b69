// SPDX-License-Identifier: Apache-2.0
// poisson_unit: depth from slopes: the divergence, then one of the solvers of the Poisson equation.
//
//   slope -> divergence -> spectral_solver, tridiagonal_solver or wide_solver -> depth
//
//   spectral_solver:     row_reorder -> dst_forward -> transpose -> dst_forward -> spectral_divide
//                        -> dst_inverse -> transpose -> dst_inverse -> row_reorder
//   tridiagonal_solver:  row_reorder -> dst_forward -> forward_elimination -> frame_stack
//                        -> back_substitution -> dst_inverse -> row_reorder
//   wide_solver:         the same with several words a clock: wide_rows -> wide_dst_forward -> wide_elimination
//                        -> wide_stack -> wide_substitution -> wide_dst_inverse
//
// Stream in: slopes in raster order. Stream out: a burst of Columns / Lanes beats for each row, Lanes depth codes in a
// beat, the first in the lowest bits; `burst_start` with the first beat of a row and depth_frame_start with the first
// of a frame; rows in raster order (tridiagonal: the bottom row first). Latency from the last slope to the first depth:
// models/tactile_depth/chip/latency.py; gaps in the input do not change it.
// Models: models/tactile_depth/chip/poisson/divergence.py, models/tactile_depth/chip/poisson/.

`default_nettype none

module poisson_unit
  import td_config_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter logic [ConfigBits-1:0] Config = DefaultConfig,
  localparam int Tridiagonal   = value(Config, TridiagonalField),  // solver: 0 spectral, 1 tridiagonal
  localparam int Neumann       = value(Config, NeumannField),
  localparam int Columns       = value(Config, ColumnsField),
  localparam int Lanes         = value(Config, LanesField),
  localparam int GradientWidth = value(Config, GradientWidthField),
  localparam int DataWidth     = value(Config, DataWidthField),
  localparam int ClippedWidth  = 8 + $clog2(Lanes)
) (
  input  wire                             clk,
  input  wire                             rst,
  input  wire                             en,
  input  wire                             slope_valid,
  input  wire position_t                  slope_position,
  input  wire  signed [GradientWidth-1:0] slope_gx,    // slope code
  input  wire  signed [GradientWidth-1:0] slope_gy,    // slope code
  output logic                            burst_start,
  output logic                            depth_frame_start,
  output logic [Lanes*DataWidth-1:0]      depth_data,  // depth codes, signed
  output logic [ClippedWidth-1:0]         saturations  // clip count, delayed
);

  localparam int InWidth = GradientWidth + 2;  // of a divergence

  logic divergence_valid, divergence_frame_start;
  logic signed [InWidth-1:0] divergence_data;
  divergence #(.Width(GradientWidth), .Columns(Columns), .Neumann(Neumann)) u_divergence (
    .clk, .rst, .en, .in_valid(slope_valid), .in_position(slope_position), .in_gx(slope_gx), .in_gy(slope_gy),
    .out_valid(divergence_valid), .out_frame_start(divergence_frame_start), .out_data(divergence_data)
  );

  if (Tridiagonal != 0 && Lanes > 1) begin : g_wide
    wide_solver #(.TableFolder(TableFolder), .Config(Config)) u_solver (
      .clk, .rst, .en,
      .in_valid(divergence_valid), .in_frame_start(divergence_frame_start), .in_data(divergence_data),
      .out_start(burst_start), .out_frame_start(depth_frame_start), .out_data(depth_data), .saturations
    );
  end else if (Tridiagonal != 0) begin : g_tridiagonal
    tridiagonal_solver #(.TableFolder(TableFolder), .Config(Config)) u_solver (
      .clk, .rst, .en,
      .in_valid(divergence_valid), .in_frame_start(divergence_frame_start), .in_data(divergence_data),
      .out_start(burst_start), .out_frame_start(depth_frame_start), .out_data(depth_data), .saturations
    );
  end else begin : g_spectral
    spectral_solver #(.TableFolder(TableFolder), .Config(Config)) u_solver (
      .clk, .rst, .en,
      .in_valid(divergence_valid), .in_frame_start(divergence_frame_start), .in_data(divergence_data),
      .out_start(burst_start), .out_frame_start(depth_frame_start), .out_data(depth_data), .saturations
    );
  end

  if ((Tridiagonal | Neumann) > 1 || (Tridiagonal | Neumann) < 0) begin : g_refused
    Tridiagonal_and_Neumann_are_0_or_1 u_refused ();
  end

endmodule

`default_nettype wire
