// SPDX-License-Identifier: Apache-2.0
// protocol_td_divide: the divisor is held from start to done; results count with done, quotients that fit alone.

`default_nettype none

module protocol_td_divide #(
  parameter int DivisorWidth  = 24,
  parameter int QuotientWidth = 25
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    start,
  input  logic [DivisorWidth-1:0] divisor,
  input  logic                    done,
  input  logic                    overflow,
  output logic                    holds,
  output logic                    counts_done,
  output logic                    counts_overflow,
  output logic                    counts
);

  logic reset, live = 1'b0;
  logic dividing = 1'b0;
  logic [DivisorWidth-1:0] held;
  assign reset = rst | ~holds;
  assign holds = rst | start | ~dividing | divisor == held;
  assign counts_done = live & ~reset;
  assign counts_overflow = counts_done & done;
  assign counts = counts_overflow & ~overflow;
  always_ff @(posedge clk) begin
    live <= live | reset;
    dividing <= ~reset & (start | (dividing & ~done));
    if (start) held <= divisor;
  end

endmodule

`default_nettype wire
