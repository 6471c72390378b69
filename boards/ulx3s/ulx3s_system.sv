// SPDX-License-Identifier: Apache-2.0
// ulx3s_system: common part of the tops of the ULX3S: serial line, reset and tactile_depth.
//
//   ftdi_txd -> uart_receive -> link_unit <-> tactile_depth;  link_unit -> uart_transmit -> ftdi_rxd
//
// Packets: docs/link.md. With Camera 0 pictures come from the serial line; with Camera 1 they come on s_axis, and those
// on the line are dropped. recorded changes with every record, doubted with every one that has a flipped bit or a
// residual beyond its bound. tactile_depth_ulx3s, with Camera tactile_sensor_ulx3s, is a wrapper, which
// `make fpga` writes for a configuration.
// Model: models/tactile_depth/chip/link/device.py around models/tactile_depth/chip/tactile_depth.py.

`default_nettype none

module ulx3s_system
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter int ClockMhz    = 100,      // of clk
  parameter int Baud        = 3000000,
  parameter int Rows        = 128,      // of the wrapper
  parameter int Columns     = 128,
  parameter int DataWidth   = 24,
  parameter int Lanes       = 1,
  parameter int BottomFirst = 0,        // 1: the bottom row leaves first
  parameter int Camera      = 0
) (
  input  wire         clk,
  input  wire         ready,          // the clock is locked, no button is pressed; from elsewhere
  output logic        rst,
  input  wire         ftdi_txd,
  output logic        ftdi_rxd,
  input  wire  [23:0] s_axis_tdata,
  input  wire         s_axis_tvalid,
  output logic        s_axis_tready,
  input  wire         s_axis_tlast,
  input  wire         s_axis_tuser,
  input  wire   [7:0] frames_lost,    // of dvp_receive
  output logic        setup_restart,  // of camera_setup
  input  wire         setup_done,
  input  wire         setup_failed,
  input  wire   [7:0] setup_entry,
  input  wire   [7:0] setup_found,
  output logic        contact,
  output logic        recorded,
  output logic        doubted,
  output logic        irq
);

  localparam int Divider = (ClockMhz * 1000000 + Baud / 2) / Baud;
  localparam int DepthBits = 8 * Lanes * ((DataWidth + 7) / 8);

  logic [3:0] resetting;
  assign rst = resetting[3];
  always_ff @(posedge clk) resetting <= {resetting[2:0], ~ready};

  logic byte_valid, broken, reply_valid, reply_ready;
  logic [7:0] byte_data, reply_data;
  uart_receive #(.Divider(Divider)) u_receive (
    .clk, .rst, .line(ftdi_txd), .out_valid(byte_valid), .out_data(byte_data), .broken
  );
  uart_transmit #(.Divider(Divider)) u_transmit (
    .clk, .rst, .in_valid(reply_valid), .in_ready(reply_ready), .in_data(reply_data), .line(ftdi_rxd)
  );

  logic [23:0] sent_tdata;
  logic sent_tvalid, sent_tready, sent_tlast, sent_tuser;
  logic [DepthBits-1:0] depth_tdata;
  logic depth_tvalid, depth_tlast, depth_tuser;
  logic [31:0] event_tdata;
  logic event_tvalid, event_tlast;
  logic [AddressWidth-1:0] awaddr, araddr;
  logic awvalid, awready, wvalid, wready, bvalid, bready, arvalid, arready, rvalid, rready;
  logic [31:0] wdata, rdata;
  logic [1:0] bresp, rresp;
  logic unused_ready;  // the line waits for nothing
  link_unit #(
    .Rows(Rows), .Columns(Columns), .DataWidth(DataWidth), .Lanes(Lanes), .BottomFirst(BottomFirst),
    .AddressWidth(AddressWidth)
  ) u_link (
    .clk, .rst, .cold_rst(1'b0), .in_valid(byte_valid), .in_ready(unused_ready), .in_data(byte_data),
    .in_broken(broken), .out_valid(reply_valid), .out_ready(reply_ready), .out_data(reply_data),
    .m_axis_tdata(sent_tdata), .m_axis_tvalid(sent_tvalid), .m_axis_tready(sent_tready), .m_axis_tlast(sent_tlast),
    .m_axis_tuser(sent_tuser), .s_axis_tdata(depth_tdata), .s_axis_tvalid(depth_tvalid), .s_axis_tlast(depth_tlast),
    .s_axis_tuser(depth_tuser), .s_event_tdata(event_tdata), .s_event_tvalid(event_tvalid),
    .s_event_tlast(event_tlast), .m_axil_awaddr(awaddr), .m_axil_awvalid(awvalid), .m_axil_awready(awready),
    .m_axil_wdata(wdata), .m_axil_wvalid(wvalid), .m_axil_wready(wready), .m_axil_bresp(bresp), .m_axil_bvalid(bvalid),
    .m_axil_bready(bready), .m_axil_araddr(araddr), .m_axil_arvalid(arvalid), .m_axil_arready(arready),
    .m_axil_rdata(rdata), .m_axil_rresp(rresp), .m_axil_rvalid(rvalid), .m_axil_rready(rready)
  );

  if (Camera != 0) begin : g_camera
    tactile_sensor_ulx3s u_sensor (
      .clk, .rst, .cold_rst(1'b0),
      .s_axis_tdata, .s_axis_tvalid, .s_axis_tready, .s_axis_tlast, .s_axis_tuser,
      .m_axis_tdata(depth_tdata), .m_axis_tvalid(depth_tvalid), .m_axis_tready(1'b1),
      .m_axis_tlast(depth_tlast), .m_axis_tuser(depth_tuser),
      .contact, .irq,
      .m_event_tdata(event_tdata), .m_event_tvalid(event_tvalid), .m_event_tready(1'b1),
      .m_event_tlast(event_tlast),
      .s_axil_awaddr(awaddr), .s_axil_awprot(3'd0), .s_axil_awvalid(awvalid), .s_axil_awready(awready),
      .s_axil_wdata(wdata), .s_axil_wstrb(4'hF), .s_axil_wvalid(wvalid), .s_axil_wready(wready),
      .s_axil_bresp(bresp), .s_axil_bvalid(bvalid), .s_axil_bready(bready),
      .s_axil_araddr(araddr), .s_axil_arprot(3'd0), .s_axil_arvalid(arvalid), .s_axil_arready(arready),
      .s_axil_rdata(rdata), .s_axil_rresp(rresp), .s_axil_rvalid(rvalid), .s_axil_rready(rready),
      .frames_lost, .setup_restart, .setup_done, .setup_failed, .setup_entry, .setup_found
    );
    assign sent_tready = 1'b1;
    logic unused_sent;
    assign unused_sent = ^{sent_tdata, sent_tvalid, sent_tlast, sent_tuser};
  end else begin : g_serial
    tactile_depth_ulx3s u_depth (
      .clk, .rst, .cold_rst(1'b0),
      .s_axis_tdata(sent_tdata), .s_axis_tvalid(sent_tvalid), .s_axis_tready(sent_tready),
      .s_axis_tlast(sent_tlast), .s_axis_tuser(sent_tuser),
      .m_axis_tdata(depth_tdata), .m_axis_tvalid(depth_tvalid), .m_axis_tready(1'b1),
      .m_axis_tlast(depth_tlast), .m_axis_tuser(depth_tuser),
      .contact, .irq,
      .m_event_tdata(event_tdata), .m_event_tvalid(event_tvalid), .m_event_tready(1'b1),
      .m_event_tlast(event_tlast),
      .s_axil_awaddr(awaddr), .s_axil_awprot(3'd0), .s_axil_awvalid(awvalid), .s_axil_awready(awready),
      .s_axil_wdata(wdata), .s_axil_wstrb(4'hF), .s_axil_wvalid(wvalid), .s_axil_wready(wready),
      .s_axil_bresp(bresp), .s_axil_bvalid(bvalid), .s_axil_bready(bready),
      .s_axil_araddr(araddr), .s_axil_arprot(3'd0), .s_axil_arvalid(arvalid), .s_axil_arready(arready),
      .s_axil_rdata(rdata), .s_axil_rresp(rresp), .s_axil_rvalid(rvalid), .s_axil_rready(rready)
    );
    assign s_axis_tready = 1'b0;
    assign setup_restart = 1'b0;
    logic unused_camera;
    assign unused_camera = ^{s_axis_tdata, s_axis_tvalid, s_axis_tlast, s_axis_tuser, frames_lost, setup_done,
      setup_failed, setup_entry, setup_found};
  end

  localparam int FlagsWord = RecordWords - $bits(frame_flags_t) / 32;  // the flags end a record
  wire frame_flags_t flags = $bits(frame_flags_t)'(event_tdata);  // in the first of their words
  logic [3:0] event_word;
  always_ff @(posedge clk) begin
    if (event_tvalid) event_word <= event_tlast ? '0 : event_word + 4'd1;
    if (event_tvalid && event_tlast) recorded <= ~recorded;
    if (event_tvalid && event_word == 4'(FlagsWord)
        && (flags.flipped || flags.residual)) doubted <= ~doubted;
    if (rst) {event_word, recorded, doubted} <= '0;
  end

endmodule

`default_nettype wire
