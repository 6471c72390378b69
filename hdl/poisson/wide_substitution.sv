// SPDX-License-Identifier: Apache-2.0
// wide_substitution: the way up of Thomas's algorithm, one row after the other, several modes of it a clock.
//
//   z[i] = e[i] + c[i] c[i+1] z[i+2],  z[Rows] = z[Rows+1] = 0
//
// Stream in: pairs of rows of e, last row first, each row Beats = Columns / Words clocks with Words modes each; in a
// frame pair follows pair without a pause; a start comes 6 clocks before the first words of a pair. Stream out: pairs
// of z, Width bits; a start comes 2 clocks before the first words. Latency: 2 clocks. The rows of a pair do not depend
// on each other, so z has 2 Beats clocks to the next product. One multiplier for each word.
// Bit-accurate model: models/tactile_depth/chip/poisson/wide_substitution.py.

`default_nettype none

module wide_substitution #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Width        = 27,
  parameter int CoeffWidth   = 18,
  parameter int Rows         = 128,
  parameter int Columns      = 128,
  parameter int Words        = 8,  // a power of two, 2 to Columns / 2
  parameter int InWidth      = 24,
  parameter int Drop         = -3,  // fraction bits from e to z; negative: added
  parameter int TableWords   = 717,
  parameter int SettledWidth = 7,
  localparam int ClippedWidth = $clog2(Words + 1)
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire                     in_start,         // 6 clocks before the first words of a pair
  input  wire                     in_frame_start,   // with in_start: the first pair of a frame
  input  wire                     in_alone,         // with in_start: the second row does not count
  input  wire [Words*InWidth-1:0] in_data,          // e, F fraction bits
  output logic                    out_start,        // 2 clocks before the first words of a pair
  output logic                    out_frame_start,
  output logic                    out_alone,
  output logic [Words*Width-1:0]  out_data,         // z, F - Drop fraction bits
  output logic [ClippedWidth-1:0] saturations       // clip count, delayed
);

  localparam int Beats = Columns / Words;
  localparam int BeatWidth = $clog2(Beats);
  localparam int RowWidth = $clog2(Rows);
  localparam int ProductWidth = Width + CoeffWidth;
  localparam int Align = CoeffWidth - 1 - Drop;
  localparam int SumWidth = (InWidth + Align > ProductWidth ? InWidth + Align : ProductWidth) + 1;
  localparam int ToWords = 6;
  localparam int ToSum = ToWords + 1;
  localparam int Direct = 4;  // clocks from z through the next product to z

  logic [BeatWidth:0] position;  // in a pair
  logic active, alone, alone_q;
  logic [RowWidth-1:0] row, row_q;  // the lower row of the pair
  td_burst_counter #(.Words(2 * Beats)) u_counter (
    .clk, .rst, .en, .start(in_start), .position, .active
  );
  assign row = in_start & in_frame_start ? RowWidth'(Rows - 1) : row_q;
  assign alone = in_start ? in_alone : alone_q;

  logic [Words*CoeffWidth-1:0] coefficients;  // minus the products of two
  thomas_table #(
    .TableFolder(TableFolder), .Table("wide_up"), .CoeffWidth(Words * CoeffWidth), .Rows(Rows), .Columns(Beats),
    .Words(TableWords), .SettledWidth(SettledWidth), .HasLastRow(1'b0)
  ) u_table (
    .clk, .en, .position(position[BeatWidth-1:0]), .row(row - RowWidth'(position[BeatWidth])),
    .coefficient(coefficients), .shift()
  );

  logic [ToWords-1:0] start_q, frame_start_q, alone_start_q;
  logic [ToSum-1:0] active_q;
  logic [ToWords-3:0] last_q;  // the last two rows: nothing is below
  always_ff @(posedge clk) begin
    if (en) begin
      alone_q <= alone;
      row_q <= row - (active && position == (BeatWidth + 1)'(2 * Beats - 1) ? RowWidth'(2) : '0);
      start_q <= {start_q[ToWords-2:0], in_start};
      frame_start_q <= {frame_start_q[ToWords-2:0], in_frame_start};
      alone_start_q <= {alone_start_q[ToWords-2:0], in_alone};
      active_q <= {active_q[ToSum-2:0], active & ~(alone & position[BeatWidth])};
      last_q <= {last_q[ToWords-4:0], row == RowWidth'(Rows - 1)};
    end
    if (rst) {start_q, frame_start_q, active_q} <= '0;
  end
  assign out_start = start_q[ToWords-1];
  assign out_frame_start = frame_start_q[ToWords-1];
  assign out_alone = alone_start_q[ToWords-1];

  logic [Words-1:0] clipped_q;
  for (genvar word = 0; word < Words; word++) begin : g_word
    logic signed [Width-1:0] below, below_q, rounded;
    logic signed [ProductWidth-1:0] product;
    logic signed [SumWidth-1:0] sum;
    logic clipped;
    if (2 * Beats == Direct) begin : g_direct
      assign below = out_data[word*Width+:Width];
    end else begin : g_waits
      td_delay_line #(.Width(Width), .Delay(2 * Beats - Direct)) u_below (
        .clk, .rst, .en, .in(out_data[word*Width+:Width]), .out(below)
      );
    end
    td_multiply #(.AWidth(Width), .BWidth(CoeffWidth)) u_product (
      .clk, .en, .a(below_q), .b(coefficients[word*CoeffWidth+:CoeffWidth]), .product
    );
    td_round_saturate #(.InWidth(SumWidth), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_round (
      .in(sum), .out(rounded), .clipped
    );
    always_ff @(posedge clk) begin
      if (en) begin
        below_q <= last_q[ToWords-3] ? '0 : below;
        sum <= (SumWidth'($signed(in_data[word*InWidth+:InWidth])) <<< Align) - SumWidth'(product);
        out_data[word*Width+:Width] <= rounded;
      end
      clipped_q[word] <= en & active_q[ToSum-1] & clipped;
      if (rst) clipped_q[word] <= 1'b0;
    end
  end

  logic [ClippedWidth-1:0] clipped_all;
  always_comb begin
    clipped_all = '0;
    for (int word = 0; word < Words; word++) clipped_all = clipped_all + ClippedWidth'(clipped_q[word]);
  end
  always_ff @(posedge clk) begin
    saturations <= clipped_all;
    if (rst) saturations <= '0;
  end

endmodule

`default_nettype wire
