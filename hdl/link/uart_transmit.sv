// SPDX-License-Identifier: Apache-2.0
// uart_transmit: bytes onto a serial line of 8 bits, lowest first, no parity, one stop bit.
//
// Bytes in: ready/valid; one is taken when the line is free. Model: models/tactile_depth/chip/link/uart.py.

`default_nettype none

module uart_transmit #(
  parameter int Divider = 33  // clocks a bit
) (
  input  wire        clk,
  input  wire        rst,
  input  wire        in_valid,
  output logic       in_ready,
  input  wire  [7:0] in_data,
  output logic       line
);

  localparam int CountWidth = $clog2(Divider);
  localparam int Bits = 10;

  logic [CountWidth-1:0] count;  // clocks that the bit on the line stays, less one
  logic [3:0] left;              // bits not yet over
  logic [Bits-2:0] rest;         // those after the one on the line

  assign in_ready = left == '0;

  always_ff @(posedge clk) begin
    if (in_ready) begin
      if (in_valid) begin
        line <= 1'b0;
        rest <= {1'b1, in_data};
        left <= 4'(Bits);
      end
      count <= CountWidth'(Divider - 1);
    end else if (count != '0) begin
      count <= count - CountWidth'(1);
    end else begin
      count <= CountWidth'(Divider - 1);
      left <= left - 4'd1;
      {rest, line} <= {1'b1, rest};
    end
    if (rst) begin
      line <= 1'b1;
      left <= '0;
    end
  end

  if (Divider < 2) begin : g_refused
    Divider_must_be_at_least_2 u_refused ();
  end

endmodule

`default_nettype wire
