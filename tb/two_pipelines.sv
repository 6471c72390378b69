// SPDX-License-Identifier: Apache-2.0
// two_pipelines: two wrappers of tactile_depth, with different configurations and tables, in one design.
//
// Both take the same clock and reset. Registers and records are not used. Simulation only.

`default_nettype none

module two_pipelines
  import td_register_map_pkg::*;
(
  input  wire         clk,
  input  wire         rst,

  input  wire  [23:0] left_s_axis_tdata,
  input  wire         left_s_axis_tvalid,
  output logic        left_s_axis_tready,
  input  wire         left_s_axis_tlast,
  input  wire         left_s_axis_tuser,
  output logic [23:0] left_m_axis_tdata,
  output logic        left_m_axis_tvalid,
  input  wire         left_m_axis_tready,
  output logic        left_m_axis_tlast,
  output logic        left_m_axis_tuser,

  input  wire  [23:0] right_s_axis_tdata,
  input  wire         right_s_axis_tvalid,
  output logic        right_s_axis_tready,
  input  wire         right_s_axis_tlast,
  input  wire         right_s_axis_tuser,
  output logic [23:0] right_m_axis_tdata,
  output logic        right_m_axis_tvalid,
  input  wire         right_m_axis_tready,
  output logic        right_m_axis_tlast,
  output logic        right_m_axis_tuser
);

  // Inputs of registers and records, which neither pipeline uses, under the names of the ports.
  wire cold_rst = 1'b0, m_event_tready = 1'b1;
  wire s_axil_awvalid = 1'b0, s_axil_wvalid = 1'b0, s_axil_bready = 1'b1, s_axil_arvalid = 1'b0, s_axil_rready = 1'b1;
  wire [AddressWidth-1:0] s_axil_awaddr = '0, s_axil_araddr = '0;
  wire [2:0] s_axil_awprot = '0, s_axil_arprot = '0;
  wire [31:0] s_axil_wdata = '0;
  wire [3:0] s_axil_wstrb = '0;

  // verilator lint_off PINCONNECTEMPTY
  tactile_depth_left u_left (
    .*,
    .s_axis_tdata(left_s_axis_tdata), .s_axis_tvalid(left_s_axis_tvalid), .s_axis_tready(left_s_axis_tready),
    .s_axis_tlast(left_s_axis_tlast), .s_axis_tuser(left_s_axis_tuser),
    .m_axis_tdata(left_m_axis_tdata), .m_axis_tvalid(left_m_axis_tvalid), .m_axis_tready(left_m_axis_tready),
    .m_axis_tlast(left_m_axis_tlast), .m_axis_tuser(left_m_axis_tuser), .contact(), .irq(), .m_event_tdata(),
    .m_event_tvalid(), .m_event_tlast(), .s_axil_awready(), .s_axil_wready(), .s_axil_bresp(), .s_axil_bvalid(),
    .s_axil_arready(), .s_axil_rdata(), .s_axil_rresp(), .s_axil_rvalid()
  );

  tactile_depth_right u_right (
    .*,
    .s_axis_tdata(right_s_axis_tdata), .s_axis_tvalid(right_s_axis_tvalid), .s_axis_tready(right_s_axis_tready),
    .s_axis_tlast(right_s_axis_tlast), .s_axis_tuser(right_s_axis_tuser),
    .m_axis_tdata(right_m_axis_tdata), .m_axis_tvalid(right_m_axis_tvalid), .m_axis_tready(right_m_axis_tready),
    .m_axis_tlast(right_m_axis_tlast), .m_axis_tuser(right_m_axis_tuser), .contact(), .irq(), .m_event_tdata(),
    .m_event_tvalid(), .m_event_tlast(), .s_axil_awready(), .s_axil_wready(), .s_axil_bresp(), .s_axil_bvalid(),
    .s_axil_arready(), .s_axil_rdata(), .s_axil_rresp(), .s_axil_rvalid()
  );

endmodule

`default_nettype wire
