// SPDX-License-Identifier: Apache-2.0
// fv_td_divide: done exactly Latency clocks after the last start; with it the quotient and the remainder, or overflow.

parameter int DivisorWidth = 3, QuotientWidth = 4;
parameter int Latency = 5;  // models/tactile_depth/chip/common/td_divide.py

logic [Latency-1:0] due;  // bit n: done is due in n clocks
logic [NumeratorWidth-1:0] numerator_q, product;
logic [DivisorWidth-1:0] divisor_q;
logic fits;
assign fits = numerator_q < {divisor_q, QuotientWidth'(0)};
assign product = NumeratorWidth'(quotient) * NumeratorWidth'(divisor_q);
always_ff @(posedge clk) begin
  due <= start ? Latency'(1) << (Latency - 1) : due >> 1;
  if (start) begin
    numerator_q <= numerator;
    divisor_q <= divisor;
  end
  if (rst) due <= '0;
end

always_comb begin
  if (started) begin
    in_time: assert (done == due[0]);
    if (done) begin
      too_large: assert (overflow == !fits);
      if (fits) divided: assert (remainder < divisor_q && numerator_q == product + NumeratorWidth'(remainder));
    end
    one_after_another: cover (done && start && fits && quotient == '1 && remainder != '0);
    overflows: cover (done && overflow && divisor_q != '0);
    abandoned: cover (start && due[1]);
  end
end

// Protocol: the divisor is held from start to done; results count with done, quotients that fit alone.
module protocol_td_divide;
  logic dividing = 1'b0;
  logic [DivisorWidth-1:0] held;
  assign holds = rst | start | ~dividing | divisor == held;
  assign counts_done = live & ~reset;
  assign counts_overflow = counts_done & done;
  assign counts = counts_overflow & ~overflow;
  always_ff @(posedge clk) begin
    dividing <= ~reset & (start | (dividing & ~done));
    if (start) held <= divisor;
  end
endmodule
