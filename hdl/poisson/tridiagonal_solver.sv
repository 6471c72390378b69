// SPDX-License-Identifier: Apache-2.0
// tridiagonal_solver: Poisson solver by sine transforms along the rows and Thomas's algorithm down the columns.
//
//   five-point Laplacian of z = f; z = 0 half a pixel outside the frame, or (Neumann) zero slope at its edge, mean zero
//
// Stream in: divergence f in raster order, gaps anywhere, whole frames only. Stream out: depth codes, bottom row first,
// one burst of Columns / Lanes clocks a row, Lanes codes a clock, the first in the lowest bits; the rows of a frame
// without a pause. Down the rows go DownWords modes a clock. Up the rows go two rows side by side, which share one
// complex transform: Lanes / 2 modes of each a clock, or with one lane one mode of each in every second row time.
// Latency: fixed, in the model, and the same after any gaps. Formats: models/tactile_depth/chip/configuration.py.
// Bit-accurate model: models/tactile_depth/chip/poisson/tridiagonal_solver.py.

`default_nettype none

module tridiagonal_solver
  import td_config_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter logic [ConfigBits-1:0] Config = DefaultConfig,
  localparam int Rows             = value(Config, RowsField),
  localparam int Columns          = value(Config, ColumnsField),  // a power of two
  localparam int Lanes            = value(Config, LanesField),  // depths a clock
  localparam int Paths            = Lanes > 1 ? Lanes / 2 : 1,  // modes of each of two rows a clock on the way up
  localparam int DownWords        = value(Config, DownWordsField),  // modes a clock on the way down
  localparam int DataWidth        = value(Config, DataWidthField),  // of a stored word, and of a depth code
  localparam int CoeffWidth       = value(Config, CoeffWidthField),
  localparam int Neumann          = value(Config, NeumannField),  // by cosine transforms
  localparam int RowForwardOut    = value(Config, RowForwardOutField),  // fraction bits dropped on the way
  localparam int RowInverseIn     = value(Config, RowInverseInField),
  localparam int RowInverseOut    = value(Config, RowInverseOutField),
  localparam int DownTableWords   = value(Config, DownTableWordsField),
  localparam int DownSettledWidth = value(Config, DownSettledWidthField),
  localparam int LastShiftWidth   = value(Config, LastShiftWidthField),
  localparam int UpTableWords     = value(Config, UpTableWordsField),
  localparam int UpSettledWidth   = value(Config, UpSettledWidthField),
  localparam int MomentDrop       = value(Config, MomentDropField),
  localparam int MeanReciprocal   = value(Config, MeanReciprocalField),
  localparam int MeanDrop         = value(Config, MeanDropField),
  localparam int StoreStyle       = value(Config, StoreStyleField),  // of a frame store, hdl/common/td_ram.sv
  localparam int WordsPerRow      = value(Config, WordsPerRowField),  // of its memory
  localparam int GradientWidth    = value(Config, GradientWidthField),
  localparam int Parity           = value(Config, ParityField),  // of the memories
  localparam int InWidth          = GradientWidth + 2,  // of a divergence
  localparam int Width            = DataWidth + GuardBits,  // of the arithmetic
  localparam int ClippedWidth     = 8 + $clog2(Lanes)
) (
  input  wire                        clk,
  input  wire                        rst,
  input  wire                        en,
  input  wire                        in_valid,
  input  wire                        in_frame_start,   // the first word of a frame
  input  wire  signed [InWidth-1:0]  in_data,          // divergence, the fraction bits of a slope
  output logic                       out_start,
  output logic                       out_frame_start,  // the first burst of a frame
  output logic [Lanes*DataWidth-1:0] out_data,         // depth codes, signed
  output logic [ClippedWidth-1:0]    saturations,      // clip count, delayed
  output logic                       flipped           // a word that was read has a flipped bit
);

  localparam int Sine = Neumann != 0 ? 0 : 1;

  // Starts come some clocks before their words, see each core.
  logic row_start, modes_start, eliminated_start, stacked_start, solved_start, depth_start;
  logic row_frame_start, modes_frame_start, eliminated_frame_start, stacked_frame_start, solved_frame_start;
  logic stacked_alone, solved_alone, depth_alone, depth_frame_start;
  logic [DownWords*InWidth-1:0] row_data;
  logic [DownWords*Width-1:0] modes;
  logic [DownWords*DataWidth-1:0] last, ahead;
  logic [2*Paths*DataWidth-1:0] stacked;
  logic [1:0][Paths*Width-1:0] solved;
  logic [1:0][Paths*DataWidth-1:0] depth;
  logic [7+$clog2(DownWords):0] clipped_forward;
  logic [$clog2(4*DownWords+3)-1:0] clipped_down;
  logic [$clog2(2*Paths+1)-1:0] clipped_up;
  logic [7+$clog2(Paths):0] clipped_inverse;

  logic [6:0] flips;  // of the cores, in the order of the data
  row_order #(.Width(InWidth), .Columns(Columns), .Paths(DownWords), .Parity(Parity)) u_rows (
    .clk, .rst, .en, .in_valid, .in_frame_start, .in_data(in_data),
    .out_start(row_start), .out_frame_start(row_frame_start), .out_data(row_data), .flipped(flips[0])
  );

  dst_forward #(
    .TableFolder(TableFolder), .Size(Columns), .Words(DownWords), .InWidth(InWidth), .Width(Width),
    .CoeffWidth(CoeffWidth), .OutputDrop(RowForwardOut), .OutWidth(Width), .Sine(Sine), .Parity(Parity)
  ) u_forward (
    .clk, .rst, .en, .in_start(row_start), .in_frame_start(row_frame_start), .in_data(row_data),
    .out_start(modes_start), .out_frame_start(modes_frame_start), .out_data(modes), .saturations(clipped_forward),
    .flipped(flips[1])
  );

  elimination #(
    .TableFolder(TableFolder), .Width(Width), .CoeffWidth(CoeffWidth), .Rows(Rows), .Columns(Columns),
    .Words(DownWords), .StoreDrop(GuardBits), .OutWidth(DataWidth), .Neumann(Neumann), .TableWords(DownTableWords),
    .SettledWidth(DownSettledWidth), .LastShiftWidth(LastShiftWidth), .MomentDrop(MomentDrop),
    .MeanReciprocal(MeanReciprocal), .MeanDrop(MeanDrop), .Parity(Parity)
  ) u_down (
    .clk, .rst, .en, .in_start(modes_start), .in_frame_start(modes_frame_start), .in_data(modes),
    .out_start(eliminated_start), .out_frame_start(eliminated_frame_start), .out_last(last), .out_ahead(ahead),
    .saturations(clipped_down), .flipped(flips[2])
  );

  frame_stack #(
    .Width(DataWidth), .Rows(Rows), .Columns(Columns), .InWords(DownWords), .Lanes(Lanes), .WordsPerRow(WordsPerRow),
    .Style(StoreStyle), .Parity(Parity)
  ) u_stack (
    .clk, .rst, .en, .in_start(eliminated_start), .in_frame_start(eliminated_frame_start), .in_last(last),
    .in_ahead(ahead), .out_start(stacked_start), .out_frame_start(stacked_frame_start), .out_alone(stacked_alone),
    .out_data(stacked), .flipped(flips[3])
  );

  substitution #(
    .TableFolder(TableFolder), .Width(Width), .CoeffWidth(CoeffWidth), .Rows(Rows), .Columns(Columns), .Paths(Paths),
    .InWidth(DataWidth), .Drop(-GuardBits), .TableWords(UpTableWords), .SettledWidth(UpSettledWidth), .Parity(Parity)
  ) u_up (
    .clk, .rst, .en, .in_start(stacked_start), .in_frame_start(stacked_frame_start), .in_alone(stacked_alone),
    .in_data(stacked), .out_start(solved_start), .out_frame_start(solved_frame_start), .out_alone(solved_alone),
    .out_data(solved), .saturations(clipped_up), .flipped(flips[4])
  );

  dst_inverse #(
    .TableFolder(TableFolder), .Size(Columns), .Paths(Paths), .InWidth(Width), .InputDrop(RowInverseIn), .Width(Width),
    .CoeffWidth(CoeffWidth), .OutputDrop(RowInverseOut), .OutWidth(DataWidth), .Sine(Sine), .Parity(Parity)
  ) u_inverse (
    .clk, .rst, .en, .in_start(solved_start), .in_frame_start(solved_frame_start), .in_alone(solved_alone),
    .in_a(solved[0]), .in_b(solved[1]), .out_start(depth_start), .out_frame_start(depth_frame_start),
    .out_alone(depth_alone), .out_a(depth[0]), .out_b(depth[1]), .saturations(clipped_inverse), .flipped(flips[5])
  );

  corner_turn #(.Width(DataWidth), .Size(Columns), .Lanes(Lanes), .Parity(Parity)) u_corner_turn (
    .clk, .rst, .en, .in_start(depth_start), .in_frame_start(depth_frame_start), .in_alone(depth_alone),
    .in_a(depth[0]), .in_b(depth[1]), .out_start, .out_frame_start, .out_data, .flipped(flips[6])
  );

  always_ff @(posedge clk) begin
    flipped <= flips != '0;
    saturations <= ClippedWidth'(clipped_forward) + ClippedWidth'(clipped_down) + ClippedWidth'(clipped_up)
        + ClippedWidth'(clipped_inverse);
    if (rst) saturations <= '0;
  end

endmodule

`default_nettype wire
