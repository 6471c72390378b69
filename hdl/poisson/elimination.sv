// SPDX-License-Identifier: Apache-2.0
// elimination: the way down of Thomas's algorithm, several modes of a row a clock, and a step of its way up.
//
//   d[i] = c[i] (f[i] - d[i-1]),  d[-1] = 0;   e[i] = d[i] - c[i] d[i+1], with which the way up looks a row ahead
//   Neumann: position 0 of the last row is minus the mean of its column, see column_mean.
//
// Stream in: bursts of Columns / Words clocks with Words modes each, in order of their positions, Rows of them a frame,
// any gaps between bursts; a start comes 2 clocks before the first words. Stream out: the same bursts, d of the row and
// e of the row above it, both rounded to the stored word; e of a frame's first row has no meaning; a start comes 6
// clocks before the first words. Latency: 9 clocks.
// The running row keeps Width bits, and c beside it. Two multipliers for each word. Bit-accurate model:
// models/tactile_depth/chip/poisson/elimination.py.

`default_nettype none

module elimination #(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Width          = 27,
  parameter int CoeffWidth     = 18,
  parameter int Rows           = 128,
  parameter int Columns        = 128,
  parameter int Words          = 1,  // a power of two up to Columns / 8
  parameter int StoreDrop      = 3,  // fraction bits dropped on the way out
  parameter int OutWidth       = 24,
  parameter int Neumann        = 0,
  parameter int TableWords     = 1102,
  parameter int SettledWidth   = 7,
  parameter int LastShiftWidth = 1,
  parameter int MomentDrop     = 7,  // Neumann: of the mean
  parameter int MeanReciprocal = 65536,
  parameter int MeanDrop       = 16,
  parameter int Parity         = 0,  // 1: a parity bit in each word of a memory
  localparam int ClippedWidth = $clog2(4 * Words + 3)
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire                       in_start,         // 2 clocks before the first words
  input  wire                       in_frame_start,   // with in_start: the first burst of a frame
  input  wire  [Words*Width-1:0]    in_data,          // modes f, F fraction bits
  output logic                      out_start,        // 6 clocks before the first words
  output logic                      out_frame_start,
  output logic [Words*OutWidth-1:0] out_last,         // d, F - StoreDrop fraction bits
  output logic [Words*OutWidth-1:0] out_ahead,        // e of the row above
  output logic [ClippedWidth-1:0]   saturations,      // clip count, delayed
  output logic                      flipped           // a word that was read, or the mean's sum, has one
);

  localparam int Clocks = Columns / Words;
  localparam int PositionWidth = $clog2(Clocks);
  localparam int RowWidth = $clog2(Rows);
  localparam int ProductWidth = Width + CoeffWidth;
  localparam int ShiftedWidth = ProductWidth + (1 << LastShiftWidth) - 1;
  localparam int ToState = 8;  // clocks from the start to d
  localparam int ToStart = ToState - 4;  // to a start 6 clocks before the words
  localparam int ToEnd = ToState + 2;  // to the words before their rounding

  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row, row_q;
  logic active;
  assign row = in_frame_start ? '0 : row_q;
  assign active = in_start | (position != '0);  // the counter rests at 0: no path leads from in_start to the table

  logic table_flipped, d_flipped, c_flipped, mean_flipped;
  assign flipped = table_flipped | d_flipped | c_flipped | mean_flipped;
  logic [Words*CoeffWidth-1:0] coefficients;
  logic [Words*LastShiftWidth-1:0] shifts, shifts_q;
  thomas_table #(
    .TableFolder(TableFolder), .Table("down"), .CoeffWidth(Words * CoeffWidth), .Rows(Rows), .Columns(Clocks),
    .Words(TableWords), .SettledWidth(SettledWidth), .LastShiftWidth(Words * LastShiftWidth), .Parity(Parity)
  ) u_table (
    .clk, .en, .position, .row, .coefficient(coefficients), .shift(shifts), .flipped(table_flipped)
  );

  // What follows the words down the pipeline.
  logic [ToState-2:0] start_q, frame_start_q;
  logic [ToEnd-1:0] active_q, first_q, last_q;  // first, last: row of a frame
  logic [ToState-1:0][PositionWidth-1:0] position_q;
  always_ff @(posedge clk) begin
    if (en) begin
      if (active) position <= position + PositionWidth'(1);
      start_q <= {start_q[ToState-3:0], in_start};
      frame_start_q <= {frame_start_q[ToState-3:0], in_frame_start};
      active_q <= {active_q[ToEnd-2:0], active};
      first_q <= {first_q[ToEnd-2:0], row == '0};
      last_q <= {last_q[ToEnd-2:0], row == RowWidth'(Rows - 1)};
      position_q <= {position_q[ToState-2:0], position};
      row_q <= row + RowWidth'(active & (position == PositionWidth'(Clocks - 1)));
      out_start <= start_q[ToStart-1];
      out_frame_start <= frame_start_q[ToStart-1];
      shifts_q <= shifts;
    end
    if (rst) {position, start_q, frame_start_q, active_q, out_start, out_frame_start} <= '0;
  end

  // The row above: d and its c, behind a register.
  logic [Words*Width-1:0] d, above_d;
  logic [Words*CoeffWidth-1:0] above_c;
  logic [2:0][Words*CoeffWidth-1:0] coefficients_q;
  always_ff @(posedge clk) if (en) coefficients_q <= {coefficients_q[1:0], coefficients};
  td_parity_ram #(.Width(Words * Width), .Depth(Clocks), .Latency(2), .Parity(Parity)) u_d_above (
    .clk, .en,
    .write_en     (en & active_q[ToState-1]),
    .write_address(position_q[ToState-1]),
    .write_data   (d),
    .read_en      (en & active_q[1]),
    .read_address (position_q[1]),
    .read_data    (above_d),
    .flipped      (d_flipped)
  );
  td_parity_ram #(.Width(Words * CoeffWidth), .Depth(Clocks), .Latency(2), .Parity(Parity)) u_c_above (
    .clk, .en,
    .write_en     (en & active_q[ToState-1]),
    .write_address(position_q[ToState-1]),
    .write_data   (coefficients_q[2]),
    .read_en      (en & active_q[1]),
    .read_address (position_q[1]),
    .read_data    (above_c),
    .flipped      (c_flipped)
  );

  logic [1:0] clipped_mean;
  logic signed [Width-1:0] mean;
  if (Neumann != 0) begin : g_mean
    column_mean #(
      .Width(Width), .CoeffWidth(CoeffWidth), .Rows(Rows), .MomentDrop(MomentDrop), .MeanReciprocal(MeanReciprocal),
      .MeanDrop(MeanDrop), .Parity(Parity)
    ) u_mean (
      .clk, .rst, .en, .in_next(start_q[ToState-2]), .in_frame_start(frame_start_q[ToState-2]), .in_data(d[Width-1:0]),
      .mean, .clipped(clipped_mean), .flipped(mean_flipped)
    );
  end else begin : g_no_mean
    assign mean = '0;
    assign clipped_mean = '0;
    assign mean_flipped = 1'b0;
  end

  logic [4*Words-1:0] clipped;
  for (genvar word = 0; word < Words; word++) begin : g_word
    // Difference, product, shift, rounding.
    localparam int AboveClocks = ToState - 3;  // from the register to the sum
    logic [AboveClocks-1:0][Width-1:0] above_q;
    logic [1:0][Width-1:0] data_q;
    logic signed [Width-1:0] above, difference, difference_q, rounded;
    logic signed [ProductWidth-1:0] product;
    logic signed [ShiftedWidth-1:0] shifted;
    logic [3:0] clipped_now;
    assign above = first_q[3] ? '0 : above_d[word*Width+:Width];
    td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_difference (
      .in((Width + 1)'($signed(data_q[1])) - (Width + 1)'(above)), .out(difference), .clipped(clipped_now[0])
    );
    td_multiply #(.AWidth(Width), .BWidth(CoeffWidth)) u_product (
      .clk, .en, .a(difference_q), .b(coefficients[word*CoeffWidth+:CoeffWidth]), .product
    );
    td_round_saturate #(.InWidth(ShiftedWidth), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_state (
      .in(shifted), .out(rounded), .clipped(clipped_now[1])
    );
    logic singular;  // position 0 of the last row
    assign singular = Neumann != 0 && word == 0 && start_q[ToState-2] && last_q[ToState-2];

    // A row ahead: d of the row above less c times d.
    logic [AboveClocks-2:0][CoeffWidth-1:0] above_c_q;
    logic [1:0][Width-1:0] d_q;
    logic signed [ProductWidth-1:0] ahead_product;
    logic signed [ProductWidth:0] ahead;
    logic signed [OutWidth-1:0] ahead_rounded, last_rounded;
    td_multiply #(.AWidth(Width), .BWidth(CoeffWidth)) u_ahead (
      .clk, .en, .a(d[word*Width+:Width]), .b(above_c_q[AboveClocks-2]), .product(ahead_product)
    );
    td_round_saturate #(.InWidth(ProductWidth + 1), .Drop(CoeffWidth - 1 + StoreDrop), .OutWidth(OutWidth)) u_round (
      .in(ahead), .out(ahead_rounded), .clipped(clipped_now[2])
    );
    td_round_saturate #(.InWidth(Width), .Drop(StoreDrop), .OutWidth(OutWidth)) u_last (
      .in(d_q[1]), .out(last_rounded), .clipped(clipped_now[3])
    );
    always_ff @(posedge clk) begin
      if (en) begin
        data_q <= {data_q[0], in_data[word*Width+:Width]};
        difference_q <= difference;
        shifted <= ShiftedWidth'(product) <<< shifts_q[word*LastShiftWidth+:LastShiftWidth];
        d[word*Width+:Width] <= singular ? mean : rounded;
        above_q <= {above_q[AboveClocks-2:0], above_d[word*Width+:Width]};
        above_c_q <= {above_c_q[AboveClocks-3:0], above_c[word*CoeffWidth+:CoeffWidth]};
        d_q <= {d_q[0], d[word*Width+:Width]};
        ahead <= ((ProductWidth + 1)'($signed(above_q[AboveClocks-1])) <<< (CoeffWidth - 1))
            - (ProductWidth + 1)'(ahead_product);
        out_last[word*OutWidth+:OutWidth] <= last_rounded;
        out_ahead[word*OutWidth+:OutWidth] <= ahead_rounded;
      end
      clipped[4*word+:4] <= clipped_now & {
        active_q[ToEnd-1] & last_q[ToEnd-1], active_q[ToEnd-1] & ~first_q[ToEnd-1], active_q[ToState-2], active_q[3]
      } & {4{en}};
      if (rst) clipped[4*word+:4] <= '0;
    end
  end

  logic [ClippedWidth-1:0] clipped_in_mean, clipped_all;
  assign clipped_in_mean = ClippedWidth'(clipped_mean[0]) + ClippedWidth'(clipped_mean[1]);
  always_comb begin
    clipped_all = clipped_in_mean;
    for (int node = 0; node < 4 * Words; node++) clipped_all = clipped_all + ClippedWidth'(clipped[node]);
  end
  always_ff @(posedge clk) begin
    saturations <= clipped_all;
    if (rst) saturations <= '0;
  end

endmodule

`default_nettype wire
