// SPDX-License-Identifier: Apache-2.0
// protocol_column_mean: rows at least 6 enabled clocks apart; a frame begins with any of them, and has at most Rows; after
// a reset none has begun. The mean counts from the row before the last one on.

`default_nettype none

module protocol_column_mean #(
  parameter int Rows  = 3,
  parameter int Width = 3
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic             in_next,
  input  logic             in_frame_start,
  output logic             holds,
  output logic [Width-1:0] counts_mean,
  output logic [1:0]       counts_clipped
);

  localparam int Apart = 6;

  logic reset, live = 1'b0;
  logic [2:0] left = '0;        // enabled clocks until a row may come
  logic [15:0] rows_left = '0;  // of the frame
  logic known = 1'b0;           // a mean of whole rows stands at the output
  logic [Apart-1:0] next_q = '0;
  assign reset = rst | ~holds;
  assign holds = rst | (in_next ? left == '0 & (in_frame_start | rows_left != '0) : ~in_frame_start);
  assign counts_mean = {Width{known & ~reset & en}};
  assign counts_clipped = {2{live & ~reset}};
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (en) begin
      left <= in_next ? 3'(Apart - 1) : left - 3'(left != '0);
      if (in_next) rows_left <= (in_frame_start ? 16'(Rows) : rows_left) - 16'd1;
      next_q <= Apart'({next_q, in_next});
      known <= known | next_q[Apart-1];
    end
    if (reset) begin
      left <= '0;
      rows_left <= '0;
      known <= 1'b0;
      next_q <= '0;
    end
  end

endmodule

`default_nettype wire
