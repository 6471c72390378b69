// SPDX-License-Identifier: Apache-2.0
// ulx3s_camera_bench: ulx3s_camera with the pull-up of SIO_D, whose two drivers are apart: cocotb drives no wire that
// others drive. Model: tb/boards/tb_ulx3s_camera_bench.py.

`default_nettype none

module ulx3s_camera_bench #(
  parameter int ClockMhz          = 100,
  parameter int Baud              = 25000000,
  parameter int Rows              = 128,
  parameter int Columns           = 128,
  parameter int DataWidth         = 24,
  parameter int Lanes             = 1,
  parameter int BottomFirst       = 0,
  parameter int Entries           = 16,
  parameter int AddressBytes      = 1,
  parameter int DeviceId          = 66,
  parameter int QuarterClocks     = 4,
  parameter int MillisecondClocks = 4
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
  input  wire        camera_pulls,  // SIO_D low
  output logic       camera_sio_d
);

  tri1 sio_d;
  assign sio_d = camera_pulls ? 1'b0 : 1'bz;
  assign camera_sio_d = sio_d;
  ulx3s_camera #(
    .ClockMhz(ClockMhz), .Baud(Baud), .Rows(Rows), .Columns(Columns), .DataWidth(DataWidth), .Lanes(Lanes),
    .BottomFirst(BottomFirst), .Entries(Entries), .AddressBytes(AddressBytes), .DeviceId(DeviceId),
    .QuarterClocks(QuarterClocks), .MillisecondClocks(MillisecondClocks)
  ) u_board (
    .clk_25mhz, .ftdi_txd, .ftdi_rxd, .btn, .led, .wifi_gpio0, .camera_pclk, .camera_vsync, .camera_href, .camera_data,
    .camera_xclk, .camera_reset_n, .camera_power_down, .camera_sio_c, .camera_sio_d(sio_d)
  );

endmodule

`default_nettype wire
