// SPDX-License-Identifier: Apache-2.0
// flip_marks: which records are of frames that a flipped bit may have damaged.
//
// `flipped` is high while a flipped bit is seen. It counts from the first record on:
// before, words are read that nobody has written. It marks the next Records records, those of the frames that were in
// flight. `marked` counts in the cycle in which a record is made, one before its record_valid. `found` is high for the
// first cycle of each flip that counts, a cycle later. Bit-accurate model:
// models/tactile_depth/chip/contact/flip_marks.py.

`default_nettype none

module flip_marks #(
  parameter int Records = 3  // at least 1
) (
  input  wire  clk,
  input  wire  rst,
  input  wire  flipped,
  input  wire  record_valid,  // the record is new in this cycle
  output logic marked,
  output logic found
);

  localparam int CountWidth = $clog2(Records + 1);

  logic begun, flipped_now, flipped_q;
  logic [CountWidth-1:0] to_mark;
  assign flipped_now = flipped & begun;
  assign marked = flipped_now | (to_mark != '0);
  always_ff @(posedge clk) begin
    if (record_valid) begun <= 1'b1;
    if (record_valid && to_mark != '0) to_mark <= to_mark - CountWidth'(1);
    if (flipped_now) to_mark <= CountWidth'(Records);
    flipped_q <= flipped_now;
    found <= flipped_now & ~flipped_q;
    if (rst) {begun, to_mark, flipped_q, found} <= '0;
  end

endmodule

`default_nettype wire
