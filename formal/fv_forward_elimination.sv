// SPDX-License-Identifier: Apache-2.0
// fv_forward_elimination: d[i] = c[i] (f[i] - d[i-1]) for every row of an arbitrary column, of any frame, 7 enabled clocks
// behind f[i], with the coefficient of its own row and column; start and frame_start with their burst. Neumann: the last
// row of column 0 is minus the mean. No word of the frame before, and none from power-up, enters: the specification has
// none, and the memories begin with any contents. Rounding is proven of round_saturate.

module fv_forward_elimination #(
  parameter int Rows    = 3,
  parameter int Size    = 8,
  parameter int Neumann = 0,
  parameter int Words   = 16,
  localparam int PositionWidth = $clog2(Size),
  localparam int RowWidth = $clog2(Rows + 1)
) (
  input logic                     clk,
  input logic                     rst,
  input logic                     en,
  input logic                     go,
  input logic                     restart,
  input logic signed [2:0]        in_data,
  input logic [PositionWidth-1:0] chosen
);

  localparam int Latency = 7;
  localparam int Width = 3;
  localparam int CoeffWidth = 3;
  localparam int OutWidth = 2;
  localparam int StoreDrop = 1;
  localparam int SettledWidth = 2;
  localparam int LastShiftWidth = 1;
  localparam int MomentDrop = 1;
  localparam int MeanReciprocal = 2;
  localparam int MeanDrop = 1;
  localparam int MomentWidth = Width + 2 * $clog2(Rows) + 2;

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  logic in_start, in_frame_start, active, last_row;
  logic [PositionWidth-1:0] position, column;  // column: chosen in the first clock, then constant
  logic [RowWidth-1:0] row;
  burst_source #(.Size(Size), .Rows(Rows)) u_source (
    .clk, .rst, .en, .go, .restart, .start(in_start), .frame_start(in_frame_start), .active, .position, .row, .last_row
  );

  logic out_start, out_frame_start;
  logic signed [OutWidth-1:0] out_data;
  logic [2:0] saturations;
  forward_elimination #(
    .Width(Width), .CoeffWidth(CoeffWidth), .Rows(Rows), .Size(Size), .StoreDrop(StoreDrop), .OutWidth(OutWidth),
    .Neumann(Neumann), .TableWords(Words), .SettledWidth(SettledWidth), .LastShiftWidth(LastShiftWidth),
    .MomentDrop(MomentDrop), .MeanReciprocal(MeanReciprocal), .MeanDrop(MeanDrop)
  ) dut (
    .clk, .rst, .en, .in_start, .in_frame_start, .in_data, .out_start, .out_frame_start, .out_data, .saturations
  );

  logic [LastShiftWidth+CoeffWidth-1:0] square[Rows*Size];
  initial $readmemh("square.hex", square);
  logic [LastShiftWidth-1:0] shift;
  logic signed [CoeffWidth-1:0] coefficient;
  assign {shift, coefficient} = square[32'(row) * Size + 32'(column)];

  // One row of the recursion in one clock.
  logic signed [Width-1:0] above, above_or_zero, difference, product, d;
  logic signed [OutWidth-1:0] stored, expected;
  logic [2:0] unused_clipped;
  logic signed [2*Width+3:0] exact;
  assign above_or_zero = row == '0 ? '0 : above;
  round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_difference (
    .in((Width + 1)'(in_data) - (Width + 1)'(above_or_zero)), .out(difference), .clipped(unused_clipped[0])
  );
  assign exact = ((2 * Width + 4)'(difference) * (2 * Width + 4)'(coefficient)) <<< shift;
  round_saturate #(.InWidth(2 * Width + 4), .Drop(CoeffWidth - 1), .OutWidth(Width)) u_product (
    .in(exact), .out(product), .clipped(unused_clipped[1])
  );
  round_saturate #(.InWidth(Width), .Drop(StoreDrop), .OutWidth(OutWidth)) u_store (
    .in(d), .out(stored), .clipped(unused_clipped[2])
  );

  logic singular;
  assign singular = Neumann != 0 && column == '0 && last_row;
  logic signed [MomentWidth-1:0] moment, moment_next;
  logic signed [Width-1:0] mean_sum, mean;
  logic [1:0] unused_mean;
  assign moment_next = (row == '0 ? '0 : moment) + MomentWidth'((32'(row) + 1) * 32'(d));
  round_saturate #(.InWidth(MomentWidth), .Drop(MomentDrop), .OutWidth(Width)) u_sum (
    .in(moment), .out(mean_sum), .clipped(unused_mean[0])
  );
  round_saturate #(.InWidth(Width + CoeffWidth), .Drop(MeanDrop), .OutWidth(Width)) u_mean (
    .in((Width + CoeffWidth)'(-MeanReciprocal * 32'(mean_sum))), .out(mean), .clipped(unused_mean[1])
  );
  assign d = singular ? mean : product;

  logic [Latency-1:0] start_q, frame_start_q, due;
  logic held;
  logic [OutWidth+1:0] out_q;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    held <= ~en & ~rst;
    out_q <= {out_start, out_frame_start, out_data};
    if (!started) column <= chosen;
    if (en) begin
      start_q <= Latency'({start_q, in_start});
      frame_start_q <= Latency'({frame_start_q, in_frame_start});
      due <= Latency'({due, active & (position == column)});
      if (active && position == column) begin
        above <= d;
        moment <= moment_next;
        expected <= stored;
      end
    end
    if (rst) begin
      start_q <= '0;
      frame_start_q <= '0;
      due <= '0;
    end
  end

  always_comb begin
    if (started) begin
      start_when_due: assert (out_start == start_q[Latency-1]);
      frame_start_when_due: assert (out_frame_start == frame_start_q[Latency-1]);
      if (due[Latency-1]) eliminated: assert (out_data == expected);
      if (held) holds: assert ({out_start, out_frame_start, out_data} == out_q);
      last_row_out: cover (due[Latency-1] && last_row && expected != '0 && expected != '1);
      if (Neumann != 0) mean_out: cover (due[Latency-1] && last_row && column == '0 && expected != '0);
    end
  end

  bind fv_forward_elimination.dut.u_state_row ram_check #(.Depth(Depth), .Defined(0)) u_check (
    .clk, .write_en, .write_address, .read_en, .read_address
  );

endmodule
