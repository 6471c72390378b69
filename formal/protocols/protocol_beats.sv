// SPDX-License-Identifier: Apache-2.0
// protocol_beats: protocol_bursts of Beats beats whose words leave 2 enabled clocks behind their starts.

`default_nettype none

module protocol_beats #(
  parameter int Beats = 8,
  parameter int Rows  = 0
) (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic in_start,
  input  logic in_frame_start,
  input  logic out_start,
  output logic holds,
  output logic counts_out_start,
  output logic counts_out_frame_start,
  output logic counts_out_alone,  // of a core that has it
  output logic counts_saturations,
  output logic counts
);

  logic [1:0] start_q;
  logic [15:0] out_left = '0;
  assign counts_out_alone = counts_out_start & out_start;
  assign counts = counts_out_start & (start_q[1] | out_left != '0);
  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= {start_q[0], out_start};
      out_left <= start_q[1] ? 16'(Beats - 1) : out_left - 16'(out_left != '0);
    end
    if (rst | ~holds) begin
      start_q <= '0;
      out_left <= '0;
    end
  end

  protocol_bursts #(.Columns(Beats), .Rows(Rows)) u_bursts (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .holds,
    .counts_out_start, .counts_out_frame_start, .counts_saturations
  );

endmodule

`default_nettype wire
