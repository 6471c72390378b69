// SPDX-License-Identifier: Apache-2.0
// protocol_dvp_receive: all inputs are allowed; outputs count after a reset, the marks of a byte while it is offered.

`default_nettype none

module protocol_dvp_receive (
  input  logic clk,
  input  logic rst,
  input  logic m_axis_tvalid,
  output logic holds,
  output logic counts_m_axis_tvalid,
  output logic counts_frames_lost,
  output logic counts_m_axis_tdata,
  output logic counts_m_axis_tlast,
  output logic counts_m_axis_tuser
);

  logic live = 1'b0, offered;
  always_ff @(posedge clk) live <= live | rst;
  assign holds = 1'b1;
  assign offered = live & m_axis_tvalid;
  assign counts_m_axis_tvalid = live;
  assign counts_frames_lost = live;
  assign counts_m_axis_tdata = offered;
  assign counts_m_axis_tlast = offered;
  assign counts_m_axis_tuser = offered;

endmodule

`default_nettype wire
