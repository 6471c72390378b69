// SPDX-License-Identifier: Apache-2.0
// protocol_td_axis_skid: the source keeps to AXI4-Stream; data count while valid.

`default_nettype none

module protocol_td_axis_skid #(
  parameter int Width = 26
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             s_valid,
  input  logic             s_ready,
  input  logic [Width-1:0] s_data,
  input  logic             m_valid,
  output logic             holds,
  output logic             counts_s_ready,
  output logic             counts_m_valid,
  output logic             counts_m_data
);

  logic reset, live = 1'b0;
  assign reset = rst | ~holds;
  always_ff @(posedge clk) live <= live | reset;
  axis_source #(.Width(Width)) u_source (
    .clk, .rst, .reset, .valid(s_valid), .ready(s_ready), .word(s_data), .holds
  );
  assign counts_s_ready = live;
  assign counts_m_valid = live;
  assign counts_m_data = live & m_valid;

endmodule

`default_nettype wire
