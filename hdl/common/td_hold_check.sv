// SPDX-License-Identifier: Apache-2.0
// td_hold_check: whether a word that waits has a flipped bit: its parity is kept from the cycle in which it is new.
//
// `comes` is high in the cycle before that. `flipped` is high one cycle after each cycle in which an odd number of bits
// differs from the word that came last, from two cycles behind `comes` on; low after a reset until a word is new.
// Bit-accurate model: models/tactile_depth/chip/common/td_hold_check.py.

`default_nettype none

module td_hold_check #(
  parameter int Width = 48
) (
  input  wire             clk,
  input  wire             rst,
  input  wire             comes,
  input  wire [Width-1:0] word,
  output logic            flipped
);

  logic is_new, known, odd, odd_now;
  assign odd_now = ^word;
  always_ff @(posedge clk) begin
    is_new <= comes;
    if (is_new) {known, odd} <= {1'b1, odd_now};
    flipped <= known & ~is_new & (odd_now ^ odd);
    if (rst) {known, flipped} <= '0;
  end

endmodule

`default_nettype wire
