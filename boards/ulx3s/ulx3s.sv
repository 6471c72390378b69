// SPDX-License-Identifier: Apache-2.0
// ulx3s: tactile_depth on the ULX3S board (LFE5U-85F): the host link over the serial port.
//
// ulx3s_system does it; here are the clock and the pins. led[0]: contact; led[1] changes with every record, led[6]
// with one that is in doubt; led[7]: the clock is locked. btn[1]: reset. Model: see ulx3s_system.

`default_nettype none

module ulx3s #(
  parameter int ClockMhz    = 100,      // of the pipeline
  parameter int Baud        = 3000000,
  parameter int Rows        = 128,      // of the wrapper
  parameter int Columns     = 128,
  parameter int DataWidth   = 24,
  parameter int Lanes       = 1,
  parameter int BottomFirst = 0         // 1: the bottom row leaves first
) (
  input  wire        clk_25mhz,
  input  wire        ftdi_txd,
  output logic       ftdi_rxd,
  input  wire  [1:1] btn,
  output logic [7:0] led,
  output logic       wifi_gpio0
);

  assign wifi_gpio0 = 1'b1;  // low, it would let the board's other chip load another bitstream

  logic clk, locked;
  ulx3s_clock #(.ClockMhz(ClockMhz)) u_clock (.clk_25mhz, .clk, .locked);

  logic contact, recorded, doubted, unused_ready, unused_rst, unused_irq, unused_restart;
  assign led = {locked, doubted, 4'd0, recorded, contact};
  ulx3s_system #(
    .ClockMhz(ClockMhz), .Baud(Baud), .Rows(Rows), .Columns(Columns), .DataWidth(DataWidth), .Lanes(Lanes),
    .BottomFirst(BottomFirst)
  ) u_system (
    .clk, .ready(locked & ~btn[1]), .rst(unused_rst), .ftdi_txd, .ftdi_rxd,
    .s_axis_tdata(24'd0), .s_axis_tvalid(1'b0), .s_axis_tready(unused_ready), .s_axis_tlast(1'b0), .s_axis_tuser(1'b0),
    .frames_lost(8'd0), .setup_restart(unused_restart), .setup_done(1'b0), .setup_failed(1'b0), .setup_entry(8'd0),
    .setup_found(8'd0),
    .contact, .recorded, .doubted, .irq(unused_irq)
  );

endmodule

`default_nettype wire
