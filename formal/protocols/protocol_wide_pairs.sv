// SPDX-License-Identifier: Apache-2.0
// protocol_wide_pairs: pairs of rows of 2 Beats clocks, in a frame of Rows rows without a pause; a frame begins with
// in_frame_start, at any pair, after less than a frame too, and after a reset none has begun. in_alone: the last pair
// of an odd number of rows, whose second row does not count. Words leave 2 enabled clocks behind the starts going out.

`default_nettype none

module protocol_wide_pairs #(
  parameter int Columns = 4,
  parameter int Words   = 2,
  parameter int Rows    = 3,
  localparam int Beats = Columns / Words,
  localparam int PositionWidth = $clog2(2 * Beats),
  localparam int PairWidth = $clog2((Rows + 1) / 2 + 1)
) (
  input  logic                     clk,
  input  logic                     rst,
  input  logic                     en,
  input  logic                     in_start,
  input  logic                     in_frame_start,
  input  logic                     in_alone,
  input  logic                     out_start,
  input  logic                     out_alone,
  output logic                     active,    // a beat of a row that counts comes in 6 enabled clocks,
  output logic [PositionWidth-1:0] position,  // with this position in its pair,
  output logic [PairWidth-1:0]     pair,      // which is this one of the frame
  output logic                     holds,
  output logic                     counts_out_start,
  output logic                     counts_out_frame_start,
  output logic                     counts_out_alone,
  output logic                     counts_saturations,
  output logic                     counts
);

  localparam int Pairs = (Rows + 1) / 2;

  logic reset, live = 1'b0, last, alone, follows;
  logic [PositionWidth-1:0] left = '0;  // clocks of the pair after this one
  logic behind = 1'b0;                  // a pair ended in the enabled clock before
  logic [PairWidth-1:0] next_pair = '0, pair_q;  // next_pair: 0 if a frame must begin
  logic [15:0] out_left = '0;
  logic [1:0] start_q = '0, alone_q;
  assign reset = rst | ~holds;
  assign position = in_start ? '0 : PositionWidth'(0) - left;
  assign pair = ~in_start ? pair_q : in_frame_start ? '0 : next_pair;
  assign last = pair == PairWidth'(Pairs - 1);
  assign alone = Rows % 2 != 0 & last;
  assign active = (in_start | left != '0) & ~(alone & position[PositionWidth-1]);
  assign follows = in_frame_start | behind & next_pair != '0;
  assign holds = in_start ? left == '0 & follows & in_alone == alone : ~in_frame_start;
  assign counts_out_start = live & ~reset & en;
  assign counts_out_frame_start = counts_out_start;
  assign counts_out_alone = counts_out_start & out_start;
  assign counts_saturations = live & ~reset;
  assign counts = counts_out_start & (start_q[1] | out_left != '0);

  always_ff @(posedge clk) begin
    live <= live | reset;
    if (en) begin
      left <= in_start ? PositionWidth'(2 * Beats - 1) : left - PositionWidth'(left != '0);
      behind <= left == PositionWidth'(1);
      if (in_start) pair_q <= pair;
      if (in_start) next_pair <= last ? '0 : pair + PairWidth'(1);
      start_q <= {start_q[0], out_start};
      alone_q <= {alone_q[0], out_alone};
      if (start_q[1]) out_left <= alone_q[1] ? 16'(Beats - 1) : 16'(2 * Beats - 1);
      else out_left <= out_left - 16'(out_left != '0);
    end
    if (reset) begin
      left <= '0;
      behind <= 1'b0;
      next_pair <= '0;
      start_q <= '0;
      out_left <= '0;
    end
  end

endmodule

`default_nettype wire
