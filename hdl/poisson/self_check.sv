// SPDX-License-Identifier: Apache-2.0
// self_check: how far the depths of a frame are from solving their equation, by sums of whole rows.
//
//   F[i] = sum_j b[j] f[i,j]    R[i] = sum_j b[j] z[i,j]    S[i] = sum_j b[j] (z[i,j-1] - 2 z[i,j] + z[i,j+1])
//   residual of row i = R[i-1] - 2 R[i] + R[i+1] + S[i] - Scale / 2^ScaleFraction F[i]
//
// It is only rounding if every bit of the solver was right. Three patterns b are in td_check_pkg: the signs of Rudin
// and Shapiro, each of them 1, 2 or 4 times, and 0 in the last column. Sums of all other columns and of the minus signs
// alone are taken; the first minus twice the second is that of the signs. An error in a transform is often the same, or
// opposite, in two columns as far from the middle: so the signs of the last pattern are opposite there, and a quarter
// of the residual of all columns but the last counts too. Of that of the last pattern half counts, as the rounding of
// coefficients adds up there. f loses InDropped low bits, z loses Dropped; a sum begins with half of what that takes
// from it. Beyond an edge z and R are those of the outer column or row (Neumann), or their complements. Sums wrap at
// SumWidth bits. There are adders only.
//
// Streams in: divergence f in raster order, gaps anywhere; depths z, a row in successive cycles with en, rows in raster
// order or the bottom row first. A row's F waits in a memory; FrameLatency says for how long. Out: for each frame the
// largest |residual| of its rows and patterns (a negative one counts as its complement), and whether it is beyond
// Bound, until the next verdict. Latency: from the last depths of a frame to its verdict 18 + log2(Lanes) cycles, with
// en or not.
// Bit-accurate model: models/tactile_depth/chip/poisson/self_check.py.

`default_nettype none

module self_check
  import td_check_pkg::*;
#(
  parameter int Rows          = 96,
  parameter int Columns       = 128,    // a power of two
  parameter int Lanes         = 1,      // depths in a cycle, a power of two
  parameter int InWidth       = 15,     // of a divergence
  parameter int Width         = 15,     // of a depth
  parameter int InDropped     = 5,
  parameter int Dropped       = 4,
  parameter int Scale         = 16130,  // below 2^ScaleFraction
  parameter int ScaleFraction = 14,
  parameter int SumWidth      = 13,
  parameter int Bound         = 195,
  parameter int Neumann       = 1,
  parameter int BottomFirst   = 1,      // 1: the bottom row of depths comes first
  parameter int FrameLatency  = 565,    // cycles with en from the last divergence to the first depth, or more
  parameter int Parity        = 0       // 1: a parity bit in each word of the memory
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire                       in_valid,
  input  wire                       in_frame_start,   // with in_valid: the first word of a frame
  input  wire  signed [InWidth-1:0] in_data,          // divergence code
  input  wire                       out_start,        // a row of depths begins
  input  wire                       out_frame_start,  // with out_start: the first row of a frame
  input  wire  [Lanes*Width-1:0]    out_data,         // depth codes, signed
  output logic [SumWidth-2:0]       residual,         // of the last frame, in units of 2^Dropped depth codes
  output logic                      beyond,           // residual > Bound
  output logic                      flipped           // a word that was read has a flipped bit
);

  localparam int Sums = CheckSums;  // of a row: of all columns but the last, then of the minus signs of each pattern
  localparam int Leave = BottomFirst != 0 ? (Rows + Lanes - 1) / Lanes : 1;
  localparam int Held = Rows + Leave + (FrameLatency + Columns - 1) / Columns + 3;  // rows that come while one waits

  logic in_sum_valid, in_sum_first;
  logic [SumWidth-1:0] in_sum;
  divergence_sums #(
    .Columns(Columns), .Width(InWidth), .Dropped(InDropped), .Scale(Scale), .ScaleFraction(ScaleFraction),
    .SumWidth(SumWidth), .LastFirst(BottomFirst)
  ) u_divergence (
    .clk, .rst, .en, .in_valid, .in_frame_start, .in_data, .out_valid(in_sum_valid),
    .out_frame_start(in_sum_first), .out_data(in_sum)
  );

  // Depths, and their second differences along the row.

  localparam int Kept = Width - Dropped;
  localparam int RiseWidth = Kept + 1 < SumWidth ? Kept + 1 : SumWidth;  // differences wrap as sums do
  localparam int SecondWidth = Kept + 2 < SumWidth ? Kept + 2 : SumWidth;
  localparam int Beats = Columns / Lanes;
  localparam int BeatWidth = $clog2(Beats);
  localparam int RowWidth = $clog2(Rows);
  localparam int Levels = $clog2(Lanes);
  localparam int Ahead = 4 + Levels;  // cycles from the last beat of a row to the last addition to sum 0

  // A beat comes with en. It moves on when the next one comes, the last one of a row by itself; behind that every clock
  // is alike, so a verdict does not wait for en.
  logic comes, ends, ended, shifts, row_first, row_last;  // row_first, row_last: of the row that ended last
  logic [BeatWidth-1:0] beat;  // of the depths that come; a start of row sets it right
  logic [RowWidth-1:0] row;
  logic [2:1] shifts_q;
  logic [Ahead:1] ends_q;
  assign comes = en & (out_start | beat != '0);
  assign ends = comes & (beat == '1);
  assign shifts = comes | ended;
  always_ff @(posedge clk) begin
    if (comes) beat <= out_start ? BeatWidth'(1) : beat + BeatWidth'(1);
    if (comes && out_start) row <= out_frame_start ? '0 : row + RowWidth'(1);
    if (ends) {row_first, row_last} <= {row == '0, row == RowWidth'(Rows - 1)};
    ended <= ends;
    shifts_q <= {shifts_q[1], shifts};
    ends_q <= {ends_q[Ahead-1:1], ends};
    if (rst) {beat, ended, shifts_q, ends_q} <= '0;
  end

  logic [Lanes-1:0][Kept-1:0] now, z, z_q, z_q2;
  logic [Lanes-1:0][RiseWidth-1:0] rise;  // to the depth on the right
  logic [RiseWidth-1:0] rise_before;      // to the first lane
  logic begins, begins_q;                 // the first beat of a row
  logic [Sums-1:0][Lanes-1:0][Kept-1:0] words;           // as they come to each sum
  logic [Sums-1:0][Lanes-1:0][SecondWidth-1:0] seconds;  // second differences there
  logic [Lanes-1:0][Sums-1:0] parts, parts_q, parts_q2;   // sums that a depth is a part of
  for (genvar l = 0; l < Lanes; l++) begin : g_lane
    logic signed [Kept-1:0] here, right;
    logic signed [RiseWidth-1:0] rise_here, rise_left;
    assign now[l] = out_data[l*Width+Dropped+:Kept];
    assign here = z_q[l];
    assign right = l == Lanes - 1 ? z[0] : z_q[(l+1)%Lanes];
    assign rise_here = rise[l];
    assign rise_left = l == 0 ? rise_before : rise[(l+Lanes-1)%Lanes];
    always_ff @(posedge clk) begin
      if (rst || (shifts && !comes)) parts[l] <= '0;
      else if (shifts) parts[l] <= check_sums((10'(beat) << Levels) | 10'($unsigned(l)), Columns);
      if (shifts_q[1]) rise[l] <= RiseWidth'(right) - RiseWidth'(here);
      seconds[0][l] <= SecondWidth'(rise_here) - SecondWidth'(rise_left);
    end
  end
  always_ff @(posedge clk) begin
    if (shifts) {z, z_q, parts_q, begins, begins_q} <= {now, z, parts, beat == '0, begins};
    if (shifts_q[1]) {z_q2, parts_q2} <= {z_q, parts_q};
    if (shifts_q[1]) rise_before <= !begins_q ? rise[Lanes-1] : Neumann != 0 ? '0 : RiseWidth'($signed({z_q[0], 1'b1}));
    words <= {words[Sums-2:0], z_q2};
    seconds[Sums-1:1] <= seconds[Sums-2:0];
    if (rst) {parts_q, parts_q2} <= '0;
  end

  // Their sums. Each is a cycle behind the one before, so that one adder is enough for what follows.

  logic [2*Sums-1:0] slots;  // a sum is there; 4 to 7: one of the row beyond the last
  logic [Sums-1:0] lasts;
  logic [Sums-1:0][SumWidth-1:0] row_r, row_s;  // one of them at most is not 0
  assign lasts = {slots[Sums-2:0], ends_q[Ahead]};
  for (genvar n = 0; n < Sums; n++) begin : g_sum
    localparam int Begin = Dropped > 0 ? check_half(2'($unsigned(n)), Columns) : 0;
    logic [n:0][Lanes-1:0] taps;
    logic [Lanes-1:0] takes;
    logic [SumWidth-1:0] sum_r, sum_s, next_r, next_s;
    for (genvar k = 1; k < 2 * Lanes; k++) begin : g_node  // below node k are 2 k and 2 k + 1, or a lane
      logic [SumWidth-1:0] node_r, node_s;
      if (k >= Lanes) begin : g_depth
        logic signed [Kept-1:0] word;
        logic signed [SecondWidth-1:0] second;
        assign takes[k-Lanes] = parts_q2[k-Lanes][n] & shifts_q[2];
        assign {word, second} = {words[n][k-Lanes], seconds[n][k-Lanes]};
        assign node_r = Lanes == 1 || taps[n][k-Lanes] ? SumWidth'(word) : '0;
        assign node_s = Lanes == 1 || taps[n][k-Lanes] ? SumWidth'(second) : '0;
      end else begin : g_add
        always_ff @(posedge clk) begin
          node_r <= g_node[2*k].node_r + g_node[2*k+1].node_r;
          node_s <= g_node[2*k].node_s + g_node[2*k+1].node_s;
          if (rst) {node_r, node_s} <= '0;
        end
      end
    end
    assign next_r = sum_r + g_node[1].node_r;
    assign next_s = sum_s + g_node[1].node_s;
    always_ff @(posedge clk) begin
      if (rst) taps <= '0;
      else taps <= ((n + 1) * Lanes)'({taps, takes});
      if (rst || lasts[n]) {sum_r, sum_s} <= {SumWidth'($unsigned(Begin)), SumWidth'(0)};
      else if (Lanes > 1 || taps[n][0]) {sum_r, sum_s} <= {next_r, next_s};
      // One lane: the last column is part of no sum.
      if (!lasts[n]) {row_r[n], row_s[n]} <= '0;
      else {row_r[n], row_s[n]} <= Lanes == 1 ? {sum_r, sum_s} : {next_r, next_s};
    end
  end

  // The equation, one sum in a cycle. What a row leaves to the next one waits while the other sums pass.

  logic first, last, slot_q, outside, read, read_q;
  logic [7:1] totals_q;
  logic [4:1] checks_q;
  logic [5:1] ends_frame_q;
  logic [SumWidth-1:0] r, s, s_before, change, bend, scaled_sum, known, rest, total, of_signs, checked;
  logic [Sums-1:0][SumWidth-1:0] r_waits, s_waits, change_waits;
  logic [SumWidth-2:0] size, largest;
  logic [SumWidth-1:0] excess;  // negative: size is larger
  assign outside = slots[2*Sums-1:Sums] != '0;
  // Words of the memory come two cycles after they are asked for.
  assign read = (ends_q[Ahead] & ~row_first) | (slots[Sums-2:0] != '0 & ~first) | (slots[Sums-1] & last)
      | slots[2*Sums-2:Sums] != '0;
  assign s = row_s[0] | row_s[1] | row_s[2] | row_s[3];
  assign checked = totals_q[4] ? SumWidth'($signed(total) >>> 2)
      : totals_q[7] ? SumWidth'($signed(of_signs) >>> 1) : of_signs;
  assign size = checked[SumWidth-2:0] ^ {(SumWidth - 1){checked[SumWidth-1]}};
  assign excess = {1'b0, largest} - {1'b0, size};
  if (Neumann != 0) begin : g_neumann
    assign r = row_r[0] | row_r[1] | row_r[2] | row_r[3];
    always_ff @(posedge clk) begin
      if (first || outside) change <= '0;
      else change <= r - r_waits[Sums-1];
    end
  end else begin : g_dirichlet
    logic [SumWidth-1:0] r_inside;
    assign r_inside = row_r[0] | row_r[1] | row_r[2] | row_r[3];
    assign r = outside ? ~r_waits[Sums-1] : r_inside;
    always_ff @(posedge clk) change <= r - (first ? ~r : r_waits[Sums-1]);
  end

  frame_ring #(
    .Width(SumWidth), .Words(Sums * Rows), .Held(Sums * Held), .LastFirst(BottomFirst),
    .Late(FrameLatency + 2 * Columns < Rows * Columns ? 0 : Rows * Columns), .Parity(Parity)
  ) u_ring (
    .clk, .rst, .en, .in_valid(in_sum_valid), .in_frame_start(in_sum_first), .in_data(in_sum), .out_en(1'b1),
    .out_frame_start(ends_q[Ahead] & row_first), .out_next(read), .out_data(scaled_sum), .flipped
  );

  always_ff @(posedge clk) begin
    slots <= {slots[2*Sums-2:Sums], slots[Sums-1] & last, slots[Sums-2:0], ends_q[Ahead]};
    if (ends_q[Ahead]) {first, last} <= {row_first, row_last};
    slot_q <= slots != '0;
    if (slots != '0) {r_waits, s_before, s_waits} <= {r_waits[Sums-2:0], r, s_waits, s};
    known <= s_before - scaled_sum;
    bend <= change - change_waits[Sums-1];
    if (slot_q) change_waits <= {change_waits[Sums-2:0], change};
    rest <= bend + known;
    if (totals_q[3]) total <= rest;
    of_signs <= total - (rest << 1);
    totals_q <= {totals_q[6:1], slots[0] | slots[Sums]};
    checks_q <= {checks_q[3:1], read_q};
    read_q <= read;
    ends_frame_q <= {ends_frame_q[4:1], slots[2*Sums-1]};
    if (ends_frame_q[5]) {residual, beyond} <= {largest, largest > (SumWidth - 1)'($unsigned(Bound))};
    if (rst || ends_frame_q[5]) largest <= '0;
    else if (checks_q[4] && excess[SumWidth-1]) largest <= size;
    if (rst) {slots, checks_q, ends_frame_q, beyond, residual} <= '0;
  end

endmodule

`default_nettype wire
