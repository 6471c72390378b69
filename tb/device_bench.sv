// SPDX-License-Identifier: Apache-2.0
// device_bench: tactile_depth behind a link_unit, whose line carries a byte a clock. device_main.cpp drives it.
//
// tactile_depth_device is a wrapper that commands/common/wrapper.py writes for each configuration. Simulation only.

`default_nettype none

// verilator lint_off PINCONNECTEMPTY
module device_bench
  import td_register_map_pkg::*;
#(
  parameter int Rows        = 128,  // of the wrapper
  parameter int Columns     = 128,
  parameter int DataWidth   = 24,
  parameter int Lanes       = 1,
  parameter int BottomFirst = 0
) (
  input  wire        clk,
  input  wire        rst,
  input  wire        cold_rst,
  input  wire        in_valid,
  output logic       in_ready,
  input  wire  [7:0] in_data,
  output logic       out_valid,
  output logic [7:0] out_data
);

  localparam int DepthBits = 8 * Lanes * ((DataWidth + 7) / 8);

  logic [23:0] picture_tdata;
  logic picture_tvalid, picture_tready, picture_tlast, picture_tuser;
  logic [DepthBits-1:0] depth_tdata;
  logic depth_tvalid, depth_tlast, depth_tuser;
  logic [31:0] event_tdata;
  logic event_tvalid, event_tlast;
  logic [AddressWidth-1:0] awaddr, araddr;
  logic awvalid, awready, wvalid, wready, bvalid, bready, arvalid, arready, rvalid, rready;
  logic [31:0] wdata, rdata;
  logic [1:0] bresp, rresp;
  link_unit #(
    .Rows(Rows), .Columns(Columns), .DataWidth(DataWidth), .Lanes(Lanes), .BottomFirst(BottomFirst),
    .AddressWidth(AddressWidth)
  ) u_link (
    .clk, .rst, .cold_rst, .in_valid, .in_ready, .in_data, .in_broken(1'b0), .out_valid, .out_ready(1'b1), .out_data,
    .m_axis_tdata(picture_tdata), .m_axis_tvalid(picture_tvalid), .m_axis_tready(picture_tready),
    .m_axis_tlast(picture_tlast), .m_axis_tuser(picture_tuser),
    .s_axis_tdata(depth_tdata), .s_axis_tvalid(depth_tvalid), .s_axis_tlast(depth_tlast), .s_axis_tuser(depth_tuser),
    .s_event_tdata(event_tdata), .s_event_tvalid(event_tvalid), .s_event_tlast(event_tlast),
    .m_axil_awaddr(awaddr), .m_axil_awvalid(awvalid), .m_axil_awready(awready),
    .m_axil_wdata(wdata), .m_axil_wvalid(wvalid), .m_axil_wready(wready),
    .m_axil_bresp(bresp), .m_axil_bvalid(bvalid), .m_axil_bready(bready),
    .m_axil_araddr(araddr), .m_axil_arvalid(arvalid), .m_axil_arready(arready),
    .m_axil_rdata(rdata), .m_axil_rresp(rresp), .m_axil_rvalid(rvalid), .m_axil_rready(rready)
  );

  tactile_depth_device u_depth (
    .clk, .rst, .cold_rst(1'b0),
    .s_axis_tdata(picture_tdata), .s_axis_tvalid(picture_tvalid), .s_axis_tready(picture_tready),
    .s_axis_tlast(picture_tlast), .s_axis_tuser(picture_tuser),
    .m_axis_tdata(depth_tdata), .m_axis_tvalid(depth_tvalid), .m_axis_tready(1'b1), .m_axis_tlast(depth_tlast),
    .m_axis_tuser(depth_tuser), .contact(), .irq(),
    .m_event_tdata(event_tdata), .m_event_tvalid(event_tvalid), .m_event_tready(1'b1), .m_event_tlast(event_tlast),
    .s_axil_awaddr(awaddr), .s_axil_awprot(3'd0), .s_axil_awvalid(awvalid), .s_axil_awready(awready),
    .s_axil_wdata(wdata), .s_axil_wstrb(4'hF), .s_axil_wvalid(wvalid), .s_axil_wready(wready),
    .s_axil_bresp(bresp), .s_axil_bvalid(bvalid), .s_axil_bready(bready),
    .s_axil_araddr(araddr), .s_axil_arprot(3'd0), .s_axil_arvalid(arvalid), .s_axil_arready(arready),
    .s_axil_rdata(rdata), .s_axil_rresp(rresp), .s_axil_rvalid(rvalid), .s_axil_rready(rready)
  );

endmodule

`default_nettype wire
