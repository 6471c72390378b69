// SPDX-License-Identifier: Apache-2.0
// protocol_tactile_depth: the source keeps to AXI4-Stream and the client to AXI4-Lite.

`default_nettype none

module protocol_tactile_depth
  import td_register_map_pkg::*;
(
  input  logic                    clk,
  input  logic                    rst,
  input  logic [23:0]             s_axis_tdata,
  input  logic                    s_axis_tvalid,
  input  logic                    s_axis_tready,
  input  logic                    s_axis_tlast,
  input  logic                    s_axis_tuser,
  input  logic                    m_axis_tvalid,
  input  logic                    m_event_tvalid,
  input  logic [AddressWidth-1:0] s_axil_awaddr,
  input  logic                    s_axil_awvalid,
  input  logic                    s_axil_awready,
  input  logic [31:0]             s_axil_wdata,
  input  logic [3:0]              s_axil_wstrb,
  input  logic                    s_axil_wvalid,
  input  logic                    s_axil_wready,
  input  logic                    s_axil_bvalid,
  input  logic [AddressWidth-1:0] s_axil_araddr,
  input  logic                    s_axil_arvalid,
  input  logic                    s_axil_arready,
  input  logic                    s_axil_rvalid,
  output logic                    holds,
  output logic                    counts_m_axis_tdata,
  output logic                    counts_m_axis_tlast,
  output logic                    counts_m_axis_tuser,
  output logic                    counts_contact,
  output logic                    counts_m_event_tvalid,
  output logic                    counts_m_event_tdata,
  output logic                    counts_m_event_tlast,
  output logic                    counts_s_axil_bresp,
  output logic                    counts_s_axil_rdata,
  output logic                    counts_s_axil_rresp,
  output logic                    counts
);

  logic reset, live = 1'b0, source_holds, client_holds;
  assign reset = rst | ~holds;
  assign holds = source_holds & client_holds;
  always_ff @(posedge clk) live <= live | reset;
  axis_source #(.Width(26)) u_source (
    .clk, .rst, .reset, .valid(s_axis_tvalid), .ready(s_axis_tready),
    .word({s_axis_tuser, s_axis_tlast, s_axis_tdata}), .holds(source_holds)
  );
  axil_client #(.AddressWidth(AddressWidth)) u_client (.*, .holds(client_holds));
  assign counts = live;
  assign {counts_m_axis_tdata, counts_m_axis_tlast, counts_m_axis_tuser} = {3{live & m_axis_tvalid}};
  assign {counts_contact, counts_m_event_tvalid} = {2{live & ~reset}};
  assign {counts_m_event_tdata, counts_m_event_tlast} = {2{live & ~reset & m_event_tvalid}};
  assign counts_s_axil_bresp = live & s_axil_bvalid;
  assign {counts_s_axil_rdata, counts_s_axil_rresp} = {2{live & s_axil_rvalid}};

endmodule

`default_nettype wire
