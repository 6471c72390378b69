// SPDX-License-Identifier: Apache-2.0
// tactile_sensor: words of a camera that films a lit gel in, depth maps and contact out.
//
//   s_axis -> camera_unit -> tactile_depth -> m_axis, contact, m_event
//             camera_unit <-> tactile_depth <-> s_axil
//
// Stream in: AXI4-Stream Video of the camera's pictures in its format (hdl/camera/pixel_format.sv). Streams out, reset
// and registers: those of tactile_depth; the registers of the camera are at 0x100 to 0x13F of the same port
// (docs/generated/camera-registers.md). Latency and models: models/tactile_depth/chip/latency.py, and those of the two
// parts.

`default_nettype none

module tactile_sensor
  import td_config_pkg::*;
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter logic [ConfigBits-1:0] Config = DefaultConfig | (ConfigBits'(1'b1) << 32 * CameraField),
  localparam int DepthBytes = value(Config, LanesField) * ((value(Config, DataWidthField) + 7) / 8)  // of a beat
) (
  input  wire                     clk,
  input  wire                     rst,  // synchronous; resets valid, ready and state, never the data path
  input  wire                     cold_rst,  // clears the banks of the tables too, at power-up; 0 on an FPGA

  input  wire  [23:0]             s_axis_tdata,
  input  wire                     s_axis_tvalid,
  output logic                    s_axis_tready,
  input  wire                     s_axis_tlast,
  input  wire                     s_axis_tuser,
  output logic [8*DepthBytes-1:0] m_axis_tdata,
  output logic                    m_axis_tvalid,
  input  wire                     m_axis_tready,
  output logic                    m_axis_tlast,
  output logic                    m_axis_tuser,
  output logic                    contact,
  output logic                    irq,  // level

  output logic [31:0]             m_event_tdata,
  output logic                    m_event_tvalid,
  input  wire                     m_event_tready,
  output logic                    m_event_tlast,

  input  wire  [AddressWidth-1:0] s_axil_awaddr,
  input  wire  [2:0]              s_axil_awprot,
  input  wire                     s_axil_awvalid,
  output logic                    s_axil_awready,
  input  wire  [31:0]             s_axil_wdata,
  input  wire  [3:0]              s_axil_wstrb,
  input  wire                     s_axil_wvalid,
  output logic                    s_axil_wready,
  output logic [1:0]              s_axil_bresp,
  output logic                    s_axil_bvalid,
  input  wire                     s_axil_bready,
  input  wire  [AddressWidth-1:0] s_axil_araddr,
  input  wire  [2:0]              s_axil_arprot,
  input  wire                     s_axil_arvalid,
  output logic                    s_axil_arready,
  output logic [31:0]             s_axil_rdata,
  output logic [1:0]              s_axil_rresp,
  output logic                    s_axil_rvalid,
  input  wire                     s_axil_rready,

  input  wire  [7:0]              frames_lost,    // of dvp_receive; 0 without one
  output logic                    setup_restart,  // of camera_setup; its other pins are 0 without one
  input  wire                     setup_done,
  input  wire                     setup_failed,
  input  wire  [7:0]              setup_entry,
  input  wire  [7:0]              setup_found
);

  logic [23:0] grid_tdata;
  logic grid_tvalid, grid_tready, grid_tlast, grid_tuser;
  register_command_t register_command;
  register_answer_t register_answer;
  camera_unit #(.Config(Config)) u_camera (
    .clk, .rst, .register_command, .register_answer, .frames_lost, .setup_restart, .setup_done, .setup_failed,
    .setup_entry, .setup_found, .s_axis_tdata, .s_axis_tvalid, .s_axis_tready, .s_axis_tlast, .s_axis_tuser,
    .m_axis_tdata(grid_tdata), .m_axis_tvalid(grid_tvalid), .m_axis_tready(grid_tready), .m_axis_tlast(grid_tlast),
    .m_axis_tuser(grid_tuser)
  );
  tactile_depth #(.TableFolder(TableFolder), .Config(Config)) u_pipeline (
    .clk, .rst, .cold_rst, .s_axis_tdata(grid_tdata), .s_axis_tvalid(grid_tvalid), .s_axis_tready(grid_tready),
    .s_axis_tlast(grid_tlast), .s_axis_tuser(grid_tuser), .m_axis_tdata, .m_axis_tvalid, .m_axis_tready,
    .m_axis_tlast, .m_axis_tuser, .contact, .irq, .m_event_tdata, .m_event_tvalid, .m_event_tready, .m_event_tlast,
    .s_axil_awaddr, .s_axil_awprot, .s_axil_awvalid, .s_axil_awready, .s_axil_wdata, .s_axil_wstrb, .s_axil_wvalid,
    .s_axil_wready, .s_axil_bresp, .s_axil_bvalid, .s_axil_bready, .s_axil_araddr, .s_axil_arprot, .s_axil_arvalid,
    .s_axil_arready, .s_axil_rdata, .s_axil_rresp, .s_axil_rvalid, .s_axil_rready, .register_command,
    .register_answer
  );

  if (value(Config, CameraField) != 1) begin : g_refused
    Config_has_no_camera u_refused ();
  end

endmodule

`default_nettype wire
