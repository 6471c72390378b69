// SPDX-License-Identifier: Apache-2.0
// substitution: the way up of Thomas's algorithm, two rows side by side, the same modes of both in a clock.
//
//   z[i] = e[i] + c[i] c[i+1] z[i+2] from the last row up, z[Rows] = z[Rows+1] = 0
//
// Stream in: pairs of rows of e, last row first, bursts of Beats = Columns / Paths clocks, Paths modes of the lower row
// and as many of the upper one a clock; a start comes 6 clocks before the first words. Stream out: pairs of z, Width
// bits; a start comes 2 clocks before the first words. Latency: 2 clocks. The rows of a pair do not depend on each
// other, so z has Beats clocks to the next product; if these are 4, pairs of a frame follow without a pause. One
// multiplier for each word.
// Bit-accurate model: models/tactile_depth/chip/poisson/substitution.py.

`default_nettype none

module substitution #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Width        = 27,
  parameter int CoeffWidth   = 18,
  parameter int Rows         = 128,
  parameter int Columns      = 128,
  parameter int Paths        = 1,  // a power of two up to Columns / 4
  parameter int InWidth      = 24,
  parameter int Drop         = -3,  // fraction bits from e to z; negative: added
  parameter int TableWords   = 717,
  parameter int SettledWidth = 7,
  parameter int Parity       = 0,  // 1: a parity bit in each word of a memory
  localparam int Words = 2 * Paths,
  localparam int ClippedWidth = $clog2(Words + 1)
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire                     in_start,         // 6 clocks before the first words of a pair
  input  wire                     in_frame_start,   // with in_start: the first pair of a frame
  input  wire                     in_alone,         // with in_start: the upper row does not count, its z is 0
  input  wire [Words*InWidth-1:0] in_data,          // e, F fraction bits, the lower row in the lower bits
  output logic                    out_start,        // 2 clocks before the first words of a pair
  output logic                    out_frame_start,
  output logic                    out_alone,
  output logic [Words*Width-1:0]  out_data,         // z, F - Drop fraction bits
  output logic [ClippedWidth-1:0] saturations,      // clip count, delayed
  output logic                    flipped           // a word that was read has a flipped bit
);

  localparam int Beats = Columns / Paths;
  localparam int BeatWidth = $clog2(Beats);
  localparam int Pairs = (Rows + 1) / 2;
  localparam int PairWidth = $clog2(Pairs);
  localparam int ProductWidth = Width + CoeffWidth;
  localparam int Align = CoeffWidth - 1 - Drop;
  localparam int SumWidth = (InWidth + Align > ProductWidth ? InWidth + Align : ProductWidth) + 1;
  localparam int ToWords = 6;
  localparam int ToSum = ToWords + 1;
  localparam int Direct = 4;  // clocks from z through the next product to z
  localparam int ToBelow = ToSum + 1 - Direct;  // to the z below, which is in a register one clock later

  logic [BeatWidth-1:0] position;
  logic active;
  logic [PairWidth-1:0] pair, pair_q;  // 0: with the first row of the frame
  assign active = in_start | (position != '0);  // the counter rests at 0: no path leads from in_start to the table
  assign pair = !in_start ? pair_q : in_frame_start ? PairWidth'(Pairs - 1) : pair_q - PairWidth'(1);

  logic table_flipped;
  logic [Words-1:0] below_flipped;
  assign flipped = table_flipped | (below_flipped != '0);
  logic [Words*CoeffWidth-1:0] coefficients;  // minus the products of two
  thomas_table #(
    .TableFolder(TableFolder), .Table("up"), .CoeffWidth(Words * CoeffWidth), .Rows(Pairs), .Columns(Beats),
    .Words(TableWords), .SettledWidth(SettledWidth), .HasLastRow(1'b0), .Parity(Parity)
  ) u_table (
    .clk, .en, .position, .row(pair), .coefficient(coefficients), .shift(), .flipped(table_flipped)
  );

  logic [ToWords-1:0] start_q, frame_start_q, alone_start_q;
  logic [ToSum:0] active_q;
  logic [ToSum-1:0] alone_q;
  logic [ToBelow+1:0] first_q;  // the last two rows: nothing is below
  logic [ToSum:0][BeatWidth-1:0] position_q;
  always_ff @(posedge clk) begin
    if (en) begin
      pair_q <= pair;
      if (active) position <= position + BeatWidth'(1);
      start_q <= {start_q[ToWords-2:0], in_start};
      frame_start_q <= {frame_start_q[ToWords-2:0], in_frame_start};
      alone_start_q <= {alone_start_q[ToWords-2:0], in_alone};
      active_q <= {active_q[ToSum-1:0], active};
      alone_q <= {alone_q[ToSum-2:0], in_start ? in_alone : alone_q[0]};
      first_q <= {first_q[ToBelow:0], pair == PairWidth'(Pairs - 1)};
      position_q <= {position_q[ToSum-1:0], position};
    end
    if (rst) {position, start_q, frame_start_q, active_q} <= '0;
  end
  assign out_start = start_q[ToWords-1];
  assign out_frame_start = frame_start_q[ToWords-1];
  assign out_alone = alone_start_q[ToWords-1];

  logic [Words-1:0] clipped_q;
  for (genvar word = 0; word < Words; word++) begin : g_word
    logic signed [Width-1:0] below, rounded;  // below: behind a register
    logic signed [ProductWidth-1:0] product;
    logic signed [SumWidth-1:0] sum;
    logic clipped, none;
    assign none = word >= Paths && alone_q[ToSum-1];
    if (Beats == Direct) begin : g_direct
      assign below_flipped[word] = 1'b0;
      always_ff @(posedge clk) if (en) below <= out_data[word*Width+:Width];
    end else begin : g_waits
      td_parity_ram #(.Width(Width), .Depth(Beats), .Latency(2), .Parity(Parity)) u_below (
        .clk, .en,
        .write_en     (en & active_q[ToSum]),
        .write_address(position_q[ToSum]),
        .write_data   (out_data[word*Width+:Width]),
        .read_en      (en & active_q[ToBelow-2]),
        .read_address (position_q[ToBelow-2]),
        .read_data    (below),
        .flipped      (below_flipped[word])
      );
    end
    td_multiply #(.AWidth(Width), .BWidth(CoeffWidth)) u_product (
      .clk, .en, .a(below), .b(coefficients[word*CoeffWidth+:CoeffWidth]), .product
    );
    td_round_saturate #(.InWidth(SumWidth), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_round (
      .in(sum), .out(rounded), .clipped
    );
    always_ff @(posedge clk) begin
      if (en) begin
        sum <= (SumWidth'($signed(in_data[word*InWidth+:InWidth])) <<< Align)
            - (first_q[ToBelow+1] ? '0 : SumWidth'(product));
        out_data[word*Width+:Width] <= none ? '0 : rounded;
      end
      clipped_q[word] <= en & active_q[ToSum-1] & clipped & ~none;
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
