// SPDX-License-Identifier: Apache-2.0
// protocol_frame_stack: bursts going in as protocol_bursts allows them, bursts of Columns words going out in each lane.

`default_nettype none

module protocol_frame_stack #(
  parameter int Columns = 8,
  parameter int Rows    = 3,
  parameter int Lanes   = 1
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic             in_start,
  input  logic             in_frame_start,
  input  logic [Lanes-1:0] out_start,
  output logic             holds,
  output logic             counts_out_start,
  output logic             counts_out_frame_start,
  output logic             counts
);

  logic unused_saturations, unused_counts;
  logic [Lanes*16-1:0] out_left = '0;
  protocol_bursts #(.Columns(Columns), .Rows(Rows)) u_bursts (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start(out_start[0]), .holds, .counts_out_start,
    .counts_out_frame_start, .counts_saturations(unused_saturations), .counts(unused_counts)
  );
  assign counts = counts_out_start & (out_start != '0 | out_left != '0);
  always_ff @(posedge clk) begin
    for (int lane = 0; lane < Lanes; lane++) begin
      if (en && out_start[lane]) out_left[lane*16+:16] <= 16'(Columns - 1);
      else if (en && out_left[lane*16+:16] != '0) out_left[lane*16+:16] <= out_left[lane*16+:16] - 16'd1;
    end
    if (rst | ~holds) out_left <= '0;
  end

endmodule

`default_nettype wire
