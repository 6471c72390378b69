// SPDX-License-Identifier: Apache-2.0
// protocol_contact_events: frames as depth_frames allows them.

`default_nettype none

module protocol_contact_events #(
  parameter int Rows    = 128,
  parameter int Columns = 128,
  parameter int Lanes   = 1,   // depths in a beat
  localparam int PlaceWidth = $clog2(Rows * Columns / Lanes)
) (
  input  logic                  clk,
  input  logic                  rst,
  input  logic                  in_valid,
  input  logic [2:0]            in_position,
  input  logic                  m_event_tvalid,
  output logic [PlaceWidth-1:0] place,  // of the beat in its frame
  output logic                  holds,
  output logic                  counts_m_event_tdata,
  output logic                  counts_m_event_tlast,
  output logic                  counts
);

  logic reset;
  assign {counts_m_event_tdata, counts_m_event_tlast} = {2{counts & m_event_tvalid}};
  depth_frames #(.Rows(Rows), .Columns(Columns / Lanes)) u_frames (.*);

endmodule

`default_nettype wire
