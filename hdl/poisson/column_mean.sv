// SPDX-License-Identifier: Apache-2.0
// column_mean: minus the mean of the singular column of a Neumann frame, with which its last row gives it zero mean.
//
//   mean = -sum over the rows i but the last of (i + 1) d[i] / Rows
//
// Stream in: d of position 0, Rows of them a frame. The mean is there 4 cycles after d of the row before the last, and
// the last row must not come before. Two multipliers. An error of the mean moves all depths alike, so that they solve
// their equation too: Parity 1 checks the sum. Bit-accurate model: zero_mean in
// models/tactile_depth/chip/poisson/elimination.py.

`default_nettype none

module column_mean #(
  parameter int Width          = 27,
  parameter int CoeffWidth     = 18,
  parameter int Rows           = 128,
  parameter int MomentDrop     = 7,
  parameter int MeanReciprocal = 65536,
  parameter int MeanDrop       = 16,
  parameter int Parity         = 0   // 1: the sum has a parity while it waits for the next row
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire                     in_next,         // d comes in the next cycle
  input  wire                     in_frame_start,  // with in_next: of the first row of a frame
  input  wire  signed [Width-1:0] in_data,         // d, F fraction bits
  output logic signed [Width-1:0] mean,            // F fraction bits
  output logic [1:0]              clipped,         // each: a value of the mean was clipped, delayed
  output logic                    flipped          // the sum has a flipped bit
);

  localparam int RowWidth = $clog2(Rows);
  localparam int MomentWidth = Width + 2 * RowWidth + 2;

  logic [RowWidth:0] weight;  // of d, row + 1
  logic signed [Width+RowWidth+1:0] addend;
  logic signed [MomentWidth-1:0] moment;
  logic signed [Width-1:0] sum, sum_q, mean_now;
  logic signed [Width+CoeffWidth-1:0] scaled;
  logic [4:0] after;  // cycles since in_next
  logic [1:0] clipped_now;
  td_multiply #(.AWidth(Width), .BWidth(RowWidth + 2)) u_addend (
    .clk, .en(en & after[0]), .a(in_data), .b({1'b0, weight}), .product(addend)
  );
  td_multiply #(.AWidth(Width), .BWidth(CoeffWidth)) u_scaled (
    .clk, .en(en & after[3]), .a(sum_q), .b(CoeffWidth'(-MeanReciprocal)), .product(scaled)
  );
  td_round_saturate #(.InWidth(MomentWidth), .Drop(MomentDrop), .OutWidth(Width)) u_sum (
    .in(moment), .out(sum), .clipped(clipped_now[0])
  );
  td_round_saturate #(.InWidth(Width + CoeffWidth), .Drop(MeanDrop), .OutWidth(Width)) u_mean (
    .in(scaled), .out(mean_now), .clipped(clipped_now[1])
  );
  logic ends;  // the mean is used when the last row begins, so the last addend is that of the row before
  assign ends = weight == (RowWidth + 1)'(Rows - 1);
  always_ff @(posedge clk) begin
    if (en) begin
      after <= {after[3:0], in_next};
      if (in_next) weight <= (in_frame_start ? '0 : weight) + (RowWidth + 1)'(1);
      if (after[1]) moment <= (weight == (RowWidth + 1)'(1) ? '0 : moment) + MomentWidth'(addend);
      if (after[2]) sum_q <= sum;
      if (after[4]) mean <= mean_now;
    end
    clipped[0] <= en & after[2] & clipped_now[0] & ends;
    clipped[1] <= en & after[4] & clipped_now[1] & ends;
    if (rst) {after, clipped} <= '0;
  end

  if (Parity == 0) begin : g_plain
    assign flipped = 1'b0;
  end else begin : g_parity
    td_hold_check #(.Width(MomentWidth)) u_hold (.clk, .rst, .comes(en & after[1]), .word(moment), .flipped);
  end

endmodule

`default_nettype wire
