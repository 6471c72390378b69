// SPDX-License-Identifier: Apache-2.0
// fv_tridiagonal_solver: the first depth of a frame Latency enabled clocks behind its last word, its rows behind each other
// without a pause, and no other start, whatever the gaps, en, the words, and the state at power-up.

module fv_tridiagonal_solver #(
  parameter int Rows    = 2,
  parameter int Size    = 8,
  parameter int Latency = 77,
  parameter int Words   = 16
) (
  input logic              clk,
  input logic              rst,
  input logic              en,
  input logic              in_valid,
  input logic              restart,
  input logic signed [1:0] in_data
);

  localparam int Pixels = Rows * Size;
  localparam int CountWidth = $clog2(Pixels + 1);

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  logic in_frame_start, out_start, out_frame_start;
  logic signed [1:0] out_data;
  logic [7:0] saturations;
  tridiagonal_solver #(
    .Rows(Rows), .Size(Size), .InWidth(2), .DataWidth(2), .Width(2), .CoeffWidth(2), .RowForwardOut(0), .StoreDrop(0),
    .RowInverseIn(0), .RowInverseOut(0), .TableWords(Words), .SettledWidth(2), .LastShiftWidth(1)
  ) dut (
    .clk, .rst, .en, .in_valid, .in_frame_start, .in_data, .out_start, .out_frame_start, .out_data, .saturations
  );

  logic [CountWidth-1:0] taken, left;  // words of the frame that came; that are still to leave after this clock's
  logic frame_end, present, due;
  logic [Latency-1:0] end_q;
  assign in_frame_start = in_valid & (restart | (taken == '0));
  assign frame_end = in_valid & ~in_frame_start & (taken == CountWidth'(Pixels - 1));
  assign due = end_q[Latency-1];
  assign present = due | (left != '0);
  always_ff @(posedge clk) begin
    started <= 1'b1;
    if (en) begin
      if (in_valid) taken <= in_frame_start ? CountWidth'(1) : frame_end ? '0 : taken + CountWidth'(1);
      end_q <= Latency'({end_q, frame_end});
      left <= due ? CountWidth'(Pixels - 1) : left != '0 ? left - CountWidth'(1) : left;
    end
    if (rst) begin
      taken <= '0;
      end_q <= '0;
      left <= '0;
    end
  end

  always_comb begin
    if (started) begin
      frame_when_due: assert (out_frame_start == due);
      row_when_due: assert (out_start == (due || (left != '0 && left % CountWidth'(Size) == '0)));
      depth_leaves: cover (out_frame_start);
    end
  end

endmodule
