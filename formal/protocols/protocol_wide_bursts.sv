// SPDX-License-Identifier: Apache-2.0
// protocol_wide_bursts: protocol_bursts of Beats beats whose words leave OutLead enabled clocks behind their
// starts, OutBeats beats a burst.

`default_nettype none

module protocol_wide_bursts #(
  parameter int Beats    = 8,
  parameter int OutBeats = Beats,
  parameter int OutLead  = 2
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
  output logic counts_saturations,
  output logic counts
);

  logic words;  // the first words of a burst leave
  if (OutLead == 0) begin : g_together
    assign words = out_start;
  end else begin : g_lead
    logic [OutLead-1:0] start_q;
    assign words = start_q[OutLead-1];
    always_ff @(posedge clk) begin
      if (en) start_q <= OutLead'({start_q, out_start});
      if (rst | ~holds) start_q <= '0;
    end
  end

  logic [15:0] out_left = '0;
  assign counts = counts_out_start & (words | out_left != '0);
  always_ff @(posedge clk) begin
    if (en) out_left <= words ? 16'(OutBeats - 1) : out_left - 16'(out_left != '0);
    if (rst | ~holds) out_left <= '0;
  end

  protocol_bursts #(.Columns(Beats)) u_bursts (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .holds,
    .counts_out_start, .counts_out_frame_start, .counts_saturations
  );

endmodule

`default_nettype wire
