// SPDX-License-Identifier: Apache-2.0
// protocol_record_packets: any inputs; words of a packet count while they are valid.

`default_nettype none

module protocol_record_packets (
  input  logic clk,
  input  logic rst,
  input  logic m_event_tvalid,
  output logic counts_m_event_tdata,
  output logic counts_m_event_tlast,
  output logic counts
);

  logic live = 1'b0;
  assign counts = live & ~rst;
  assign {counts_m_event_tdata, counts_m_event_tlast} = {2{counts & m_event_tvalid}};
  always_ff @(posedge clk) live <= live | rst;

endmodule

`default_nettype wire
