// SPDX-License-Identifier: Apache-2.0
// tb_fingertip: sends the picture of pixels.hex to fingertip and compares the deepest code with that of deepest.hex.
//
// It is plain SystemVerilog, for any simulator. Whatever goes wrong is a $fatal, which ends with an exit status other
// than 0. With a time scale of its own #5 is 5 ns wherever the file stands in a list.

`timescale 1ns / 1ps

`default_nettype none

module tb_fingertip;

  localparam int Rows = 8;
  localparam int Columns = 16;
  localparam int Pixels = Rows * Columns;

  logic [23:0] pixels[0:Pixels-1];
  logic [23:0] expected[0:0];
  initial begin
    $readmemh("pixels.hex", pixels);
    $readmemh("deepest.hex", expected);
  end

  logic clk = 1'b0;
  always #5 clk = ~clk;

  int clocks = 0;
  logic rst;
  assign rst = clocks < 4;

  // A pixel leaves in each clock in which the pipeline is ready for it.
  int sent = 0;
  logic valid, ready;
  assign valid = !rst && sent < Pixels;

  logic signed [23:0] deepest;
  logic deepest_valid;
  fingertip u_fingertip (
    .clk, .rst, .pixel(pixels[sent % Pixels]), .pixel_valid(valid), .pixel_ready(ready),
    .row_end(sent % Columns == Columns - 1), .frame_start(sent == 0), .deepest, .deepest_valid
  );

  always @(posedge clk) begin
    clocks <= clocks + 1;
    if (valid && ready) sent <= sent + 1;
    if (deepest_valid) begin
      if (deepest !== $signed(expected[0])) $fatal(1, "the deepest code is %0d, not %0d", deepest, expected[0]);
      $display("the deepest code is %0d, as in the model", deepest);
      $finish;
    end
    if (clocks == 20 * Pixels) $fatal(1, "no whole frame of depth after %0d of %0d pixels", sent, Pixels);
  end

endmodule

`default_nettype wire
