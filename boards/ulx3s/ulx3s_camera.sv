// SPDX-License-Identifier: Apache-2.0
// ulx3s_camera: tactile_depth on the ULX3S board behind a parallel camera (DVP): the host link over the serial port.
//
//   camera -> dvp_receive -> tactile_sensor -> serial line (ulx3s_system)
//
// The wrapper tactile_sensor_ulx3s has the front end inside, and its registers. After a reset camera_setup brings up
// the camera, with the list camera.hex of models/tactile_depth/chip/camera/register_lists.py. A picture that is
// malformed, or cut short because its bytes found no room, is dropped whole and counted in FRAMES_DROPPED.
// led[0]: contact; led[1] changes with every record; led[2]: the camera is set up; led[3]: it did not answer as it
// should; led[4] changes when pictures were lost; led[5]: irq, as INTERRUPT_MASK asks; led[6] changes with every record
// that is in doubt; led[7]: the clock is locked. btn[1]: reset. Models: models/tactile_depth/chip/camera/,
// and see ulx3s_system.

`default_nettype none

module ulx3s_camera #(
  parameter int ClockMhz          = 100,      // of the pipeline
  parameter int Baud              = 3000000,
  parameter int Rows              = 128,      // of the wrapper
  parameter int Columns           = 128,
  parameter int DataWidth         = 24,
  parameter int Lanes             = 1,
  parameter int BottomFirst       = 0,        // 1: the bottom row leaves first
  parameter int Entries           = 16,       // of camera.hex, and below them what a camera's SCCB is like
  parameter int AddressBytes      = 1,
  parameter int DeviceId          = 66,
  parameter int QuarterClocks     = (ClockMhz * 5 + 1) / 2,  // 100 kbit/s
  parameter int MillisecondClocks = ClockMhz * 1000,
  parameter int FifoLog2          = 4
) (
  input  wire        clk_25mhz,
  input  wire        ftdi_txd,
  output logic       ftdi_rxd,
  input  wire  [1:1] btn,
  output logic [7:0] led,
  output logic       wifi_gpio0,
  input  wire        camera_pclk,
  input  wire        camera_vsync,
  input  wire        camera_href,
  input  wire  [7:0] camera_data,
  output logic       camera_xclk,
  output logic       camera_reset_n,
  output logic       camera_power_down,
  output logic       camera_sio_c,
  inout  wire        camera_sio_d
);

  localparam int FastestXclkMhz = 27;
  localparam int XclkHalfClocks = (ClockMhz + 2 * FastestXclkMhz - 1) / (2 * FastestXclkMhz);

  assign wifi_gpio0 = 1'b1;  // low, it would let the board's other chip load another bitstream

  logic clk, locked, rst;
  ulx3s_clock #(.ClockMhz(ClockMhz)) u_clock (.clk_25mhz, .clk, .locked);

  logic set_up, failed, restart, restart_q, sio_d_low;
  logic [$clog2(Entries)-1:0] entry;
  logic [7:0] found;
  assign camera_sio_d = sio_d_low ? 1'b0 : 1'bz;
  camera_setup #(
    .Entries(Entries), .AddressBytes(AddressBytes), .DeviceId(DeviceId), .QuarterClocks(QuarterClocks),
    .MillisecondClocks(MillisecondClocks), .XclkHalfClocks(XclkHalfClocks)
  ) u_setup (
    .clk, .rst, .restart(restart_q), .xclk(camera_xclk), .power_down(camera_power_down), .reset_n(camera_reset_n),
    .sio_c(camera_sio_c), .sio_d_low, .sio_d(camera_sio_d), .done(set_up), .failed, .entry, .found
  );

  logic [7:0] byte_tdata, frames_lost;
  logic byte_tvalid, byte_tready, byte_tlast, byte_tuser;
  dvp_receive #(.FifoLog2(FifoLog2)) u_receive (
    .pclk(camera_pclk), .vsync(camera_vsync), .href(camera_href), .data(camera_data),
    .clk, .rst, .m_axis_tdata(byte_tdata), .m_axis_tvalid(byte_tvalid), .m_axis_tready(byte_tready),
    .m_axis_tlast(byte_tlast), .m_axis_tuser(byte_tuser), .frames_lost
  );

  logic contact, recorded, doubted, irq, lost;
  assign led = {locked, doubted, irq, lost, failed, set_up, recorded, contact};
  ulx3s_system #(
    .ClockMhz(ClockMhz), .Baud(Baud), .Rows(Rows), .Columns(Columns), .DataWidth(DataWidth), .Lanes(Lanes),
    .BottomFirst(BottomFirst), .Camera(1)
  ) u_system (
    .clk, .ready(locked & ~btn[1]), .rst, .ftdi_txd, .ftdi_rxd,
    .s_axis_tdata({16'd0, byte_tdata}), .s_axis_tvalid(byte_tvalid), .s_axis_tready(byte_tready),
    .s_axis_tlast(byte_tlast), .s_axis_tuser(byte_tuser), .frames_lost, .setup_restart(restart), .setup_done(set_up),
    .setup_failed(failed), .setup_entry(8'(entry)), .setup_found(found), .contact, .recorded, .doubted, .irq
  );
  always_ff @(posedge clk) begin
    restart_q <= restart;  // which comes in the cycle of the write, at the end of a long path
    if (frames_lost != '0) lost <= ~lost;
    if (rst) lost <= 1'b0;
  end

endmodule

`default_nettype wire
