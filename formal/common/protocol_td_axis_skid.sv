// SPDX-License-Identifier: Apache-2.0
// protocol_td_axis_skid: any source, one that withdraws a word too; data count while valid.

`default_nettype none

module protocol_td_axis_skid (
  input  logic clk,
  input  logic rst,
  input  logic m_valid,
  output logic counts_s_ready,
  output logic counts_m_valid,
  output logic counts_m_data
);

  logic live = 1'b0;
  always_ff @(posedge clk) live <= live | rst;
  assign counts_s_ready = live;
  assign counts_m_valid = live;
  assign counts_m_data = live & m_valid;

endmodule

`default_nettype wire
