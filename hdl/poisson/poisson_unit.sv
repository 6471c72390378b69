// SPDX-License-Identifier: Apache-2.0
// poisson_unit: depth from slopes: the divergence, then one of the solvers of the Poisson equation.
//
//   slope -> divergence -> spectral_solver or tridiagonal_solver -> depth
//                      \-------------> self_check <---------------/
//
//   spectral_solver:     row_order -> dst_forward -> transpose -> dst_forward -> spectral_divide
//                        -> dst_inverse -> transpose -> dst_inverse -> corner_turn
//   tridiagonal_solver:  row_order -> dst_forward -> elimination -> frame_stack
//                        -> substitution -> dst_inverse -> corner_turn
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
  localparam int Rows          = value(Config, RowsField),
  localparam int Columns       = value(Config, ColumnsField),
  localparam int Lanes         = value(Config, LanesField),
  localparam int GradientWidth = value(Config, GradientWidthField),
  localparam int DataWidth     = value(Config, DataWidthField),
  localparam int Parity        = value(Config, ParityField),  // of the memories
  localparam int ResidualBound = value(Config, ResidualBoundField),  // 0: frames do not check themselves
  localparam int SumWidth      = value(Config, CheckSumWidthField),
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
  output logic [ClippedWidth-1:0]         saturations,  // clip count, delayed
  output logic                            flipped,     // a word that was read, or a position, has a flipped bit
  output logic [31:0]                     residual,    // of the last frame that left
  output logic                            beyond       // it is beyond its bound
);

  localparam int InWidth = GradientWidth + 2;  // of a divergence

  logic divergence_valid, divergence_frame_start;
  logic signed [InWidth-1:0] divergence_data;
  logic position_wrong, line_flipped, solver_flipped, check_flipped;
  assign flipped = position_wrong | line_flipped | solver_flipped | check_flipped;
  if (Parity != 0) begin : g_raster_check
    raster_check #(.Rows(Rows), .Columns(Columns)) u_raster (
      .clk, .rst, .en, .in_valid(slope_valid), .in_position(slope_position), .wrong(position_wrong)
    );
  end else begin : g_no_check
    assign position_wrong = 1'b0;
  end
  divergence #(.Width(GradientWidth), .Columns(Columns), .Neumann(Neumann), .Parity(Parity)) u_divergence (
    .clk, .rst, .en, .in_valid(slope_valid), .in_position(slope_position), .in_gx(slope_gx), .in_gy(slope_gy),
    .out_valid(divergence_valid), .out_frame_start(divergence_frame_start), .out_data(divergence_data),
    .flipped(line_flipped)
  );

  if (Tridiagonal != 0) begin : g_tridiagonal
    tridiagonal_solver #(.TableFolder(TableFolder), .Config(Config)) u_solver (
      .clk, .rst, .en,
      .in_valid(divergence_valid), .in_frame_start(divergence_frame_start), .in_data(divergence_data),
      .out_start(burst_start), .out_frame_start(depth_frame_start), .out_data(depth_data), .saturations,
      .flipped(solver_flipped)
    );
  end else begin : g_spectral
    spectral_solver #(.TableFolder(TableFolder), .Config(Config)) u_solver (
      .clk, .rst, .en,
      .in_valid(divergence_valid), .in_frame_start(divergence_frame_start), .in_data(divergence_data),
      .out_start(burst_start), .out_frame_start(depth_frame_start), .out_data(depth_data), .saturations,
      .flipped(solver_flipped)
    );
  end

  // The depth is put into the equation.

  if (ResidualBound != 0) begin : g_self_check
    logic [SumWidth-2:0] left;
    assign residual = 32'(left);
    self_check #(
      .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .InWidth(InWidth), .Width(DataWidth),
      .InDropped(value(Config, CheckInDroppedField)), .Dropped(value(Config, CheckDroppedField)),
      .Scale(value(Config, CheckScaleField)), .ScaleFraction(value(Config, CheckScaleFractionField)),
      .SumWidth(SumWidth), .Bound(ResidualBound), .Neumann(Neumann), .BottomFirst(Tridiagonal),
      .FrameLatency(value(Config, FrameLatencyField)), .Parity(Parity)
    ) u_self_check (
      .clk, .rst, .en, .in_valid(divergence_valid), .in_frame_start(divergence_frame_start), .in_data(divergence_data),
      .out_start(burst_start), .out_frame_start(depth_frame_start), .out_data(depth_data), .residual(left),
      .beyond, .flipped(check_flipped)
    );
  end else begin : g_no_self_check
    assign {residual, beyond, check_flipped} = '0;
  end

  // Refused.

  localparam int CoeffWidth     = value(Config, CoeffWidthField);
  localparam int StoreStyle     = value(Config, StoreStyleField);
  localparam int ShiftWidth     = value(Config, Tridiagonal != 0 ? LastShiftWidthField : DivideShiftWidthField);
  localparam int DownWords      = value(Config, DownWordsField);
  localparam int DownSettled    = value(Config, DownSettledWidthField);
  localparam int UpSettled      = value(Config, UpSettledWidthField);
  localparam int MeanReciprocal = value(Config, MeanReciprocalField);
  if ((Tridiagonal | Neumann) > 1 || (Tridiagonal | Neumann) < 0) begin : g_refused_0
    Tridiagonal_and_Neumann_are_0_or_1 u_refused ();
  end
  if (Columns < 16 || Columns > 1024 || Columns != 1 << $clog2(Columns)) begin : g_refused_1
    Columns_must_be_a_power_of_two_16_to_1024 u_refused ();
  end
  if (Rows < 8 || Rows > 1024) begin : g_refused_2
    Rows_must_be_8_to_1024 u_refused ();
  end
  if (Lanes < 1 || Lanes > 64 || 2 * Lanes > Columns || Lanes != 1 << $clog2(Lanes)) begin : g_refused_3
    Lanes_must_be_a_power_of_two_up_to_64_and_half_of_Columns u_refused ();
  end
  if (Tridiagonal == 0 && (Rows != Columns || Lanes != 1)) begin : g_refused_4
    the_spectral_solver_takes_square_grids_and_has_one_lane u_refused ();
  end
  if (DataWidth < 2 || DataWidth > 32) begin : g_refused_5
    DataWidth_must_be_2_to_32 u_refused ();
  end
  if (GradientWidth < 2 || GradientWidth > 32 || CoeffWidth < 2 || CoeffWidth > 32) begin : g_refused_6
    GradientWidth_and_CoeffWidth_must_be_2_to_32 u_refused ();
  end
  if (StoreStyle < 0 || StoreStyle > 2) begin : g_refused_7
    StoreStyle_must_be_0_to_2 u_refused ();
  end
  if (ShiftWidth < 1 || ShiftWidth > 6) begin : g_refused_8
    DivideShiftWidth_and_LastShiftWidth_must_be_1_to_6 u_refused ();
  end
  if (Tridiagonal != 0 && (DownSettled < 1 || DownSettled > 16 || UpSettled < 1 || UpSettled > 16)) begin : g_refused_9
    DownSettledWidth_and_UpSettledWidth_must_be_1_to_16 u_refused ();
  end
  if (Tridiagonal != 0 && Neumann != 0 && (MeanReciprocal < 1 || MeanReciprocal > 1 << (CoeffWidth - 1)))
  begin : g_refused_10
    MeanReciprocal_must_fit_CoeffWidth u_refused ();
  end
  if (Tridiagonal != 0 && value(Config, WordsPerRowField) < 1) begin : g_refused_11
    WordsPerRow_must_be_at_least_1 u_refused ();
  end
  if (Tridiagonal != 0 && (DownWords < 1 || DownWords > (Lanes > 1 ? Lanes / 2 : 1) || 8 * DownWords > Columns
      || DownWords != 1 << $clog2(DownWords)))
  begin : g_refused_12
    DownWords_must_be_a_power_of_two_up_to_half_of_Lanes_and_an_eighth_of_Columns u_refused ();
  end

  // Of the check.

  localparam int InDropped     = value(Config, CheckInDroppedField);
  localparam int Dropped       = value(Config, CheckDroppedField);
  localparam int Scale         = value(Config, CheckScaleField);
  localparam int ScaleFraction = value(Config, CheckScaleFractionField);
  localparam int Latency       = value(Config, FrameLatencyField);
  localparam int Beats         = Columns / (Lanes > 0 ? Lanes : 1);
  if (ResidualBound != 0) begin : g_refused_check
    if (Columns < 32 || Beats < 8 || Beats < 4 + $clog2(Lanes)) begin : g_refused_0
      a_check_needs_32_Columns_and_8_cycles_for_a_row_more_with_many_Lanes u_refused ();
    end
    if (Dropped < 0 || Dropped > DataWidth - 2 || InDropped < 0 || InDropped > InWidth - 2) begin : g_refused_1
      CheckDropped_and_CheckInDropped_must_leave_two_bits u_refused ();
    end
    if (SumWidth < DataWidth - Dropped || SumWidth < 3 || SumWidth > 32) begin : g_refused_2
      CheckSumWidth_must_be_the_bits_that_stay_of_a_depth_to_32 u_refused ();
    end
    if (ResidualBound < 0 || ResidualBound >> (SumWidth - 1) != 0) begin : g_refused_3
      ResidualBound_must_fit_a_sum u_refused ();
    end
    if (ScaleFraction < 1 || ScaleFraction > 30 || 4 * (ScaleFraction + 1) > Columns
        || 4 * (ScaleFraction + 2) > Latency + Beats)
    begin : g_refused_4
      CheckScaleFraction_must_be_1_to_30_and_leave_the_time_to_multiply u_refused ();
    end
    if (Scale < 1 || Scale >> ScaleFraction != 0) begin : g_refused_5
      CheckScale_must_be_at_least_1_and_below_2_to_the_CheckScaleFraction u_refused ();
    end
    if (Latency + 2 * Columns >= Rows * Columns
        && ((Rows & (Rows - 1)) != 0 || 2 * (Latency + 2 * Columns) > 3 * Rows * Columns))
    begin : g_refused_6
      a_check_needs_a_FrameLatency_below_a_frame_or_a_half_more_with_a_power_of_two_of_Rows u_refused ();
    end
  end

endmodule

`default_nettype wire
