// SPDX-License-Identifier: Apache-2.0
// protocol_pairs: pairs of rows side by side, protocol_bursts of Beats clocks, as many as a frame of Rows rows has.
// Pairs of 4 clocks follow each other in a frame without a pause.
// in_alone: the last pair of an odd number of rows, whose upper row does not count. Words leave 2 enabled clocks behind
// the starts going out.

`default_nettype none

module protocol_pairs #(
  parameter int Columns = 4,
  parameter int Paths   = 1,
  parameter int Rows    = 3,
  localparam int Beats = Columns / Paths,
  localparam int Pairs = (Rows + 1) / 2,
  localparam int PositionWidth = $clog2(Beats),
  localparam int PairWidth = $clog2(Pairs + 1)
) (
  input  logic                     clk,
  input  logic                     rst,
  input  logic                     en,
  input  logic                     in_start,
  input  logic                     in_frame_start,
  input  logic                     in_alone,
  input  logic                     out_start,
  output logic                     active,    // a beat comes in 6 enabled clocks,
  output logic [PositionWidth-1:0] position,  // with this position in its pair,
  output logic [PairWidth-1:0]     pair,      // which is this one of the frame,
  output logic                     last,      // and the last one
  output logic                     holds,
  output logic                     counts_out_start,
  output logic                     counts_out_frame_start,
  output logic                     counts_out_alone,
  output logic                     counts_saturations,
  output logic                     counts
);

  logic bursts, behind = 1'b0;  // behind: a pair ended in the enabled clock before
  logic [15:0] out_left = '0;
  logic [1:0] start_q = '0;
  assign holds = bursts
      & (~in_start | (in_alone == (Rows % 2 != 0 & last) & (in_frame_start | behind | Beats != 4)));
  assign counts_out_alone = counts_out_start & out_start;
  assign counts = counts_out_start & (start_q[1] | out_left != '0);
  protocol_bursts #(.Columns(Beats), .Rows(Pairs)) u_bursts (
    .clk, .rst(rst | ~holds), .en, .in_start, .in_frame_start, .out_start, .active, .position, .row(pair),
    .last_row(last), .holds(bursts), .counts_out_start, .counts_out_frame_start, .counts_saturations, .counts()
  );
  always_ff @(posedge clk) begin
    if (en) begin
      behind <= active & (position == PositionWidth'(Beats - 1));
      start_q <= {start_q[0], out_start};
      out_left <= start_q[1] ? 16'(Beats - 1) : out_left - 16'(out_left != '0);
    end
    if (rst | ~holds) begin
      start_q <= '0;
      out_left <= '0;
    end
  end

endmodule

`default_nettype wire
