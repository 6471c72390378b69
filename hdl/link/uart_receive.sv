// SPDX-License-Identifier: Apache-2.0
// uart_receive: bytes from a serial line of 8 bits, lowest first, no parity, one stop bit.
//
// A byte is there for one clock. A stop bit that is low, as in a break, gives `broken` for a clock in its place, and
// nothing more until the line is high again. A start bit shorter than half a bit is none. The line may be asynchronous;
// the rates may differ by 4 %. Bit-accurate model: models/tactile_depth/chip/link/uart.py.

`default_nettype none

module uart_receive #(
  parameter int Divider = 33  // clocks a bit
) (
  input  wire        clk,
  input  wire        rst,
  input  wire        line,
  output logic       out_valid,
  output logic [7:0] out_data,
  output logic       broken
);

  localparam int CountWidth = $clog2(Divider);
  localparam int StopBit = 9;

  logic [2:0] line_q;  // two for the crossing into this clock
  logic level;
  assign level = line_q[2];

  logic [CountWidth-1:0] count;  // clocks to the middle of the next bit, less one
  logic [3:0] position;          // of that bit: 0 start, 1 to 8 data, 9 stop
  logic busy, silent;            // silent: after a break, until the line is high

  always_ff @(posedge clk) begin
    line_q <= {line_q[1:0], line};
    out_valid <= 1'b0;
    broken <= 1'b0;
    if (level) silent <= 1'b0;
    if (!busy) begin
      busy <= ~level & ~silent;
      count <= CountWidth'(Divider / 2 - 1);
      position <= '0;
    end else if (count != '0) begin
      count <= count - CountWidth'(1);
    end else begin
      count <= CountWidth'(Divider - 1);
      position <= position + 4'd1;
      if (position == '0) begin
        busy <= ~level;
      end else if (position == 4'(StopBit)) begin
        busy <= 1'b0;
        out_valid <= level;
        broken <= ~level;
        silent <= ~level;
      end else begin
        out_data <= {level, out_data[7:1]};
      end
    end
    if (rst) begin
      busy <= 1'b0;
      silent <= 1'b1;
      out_valid <= 1'b0;
      broken <= 1'b0;
    end
  end

  if (Divider < 4) begin : g_refused
    Divider_must_be_at_least_4 u_refused ();
  end

endmodule

`default_nettype wire
