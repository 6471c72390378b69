// SPDX-License-Identifier: Apache-2.0
// td_burst_counter: position of the word now present in a burst of Words words.
//
// A burst is Words words in successive enabled cycles; start comes with the first. position and active are
// combinational with start; bursts may follow each other without a pause. A start inside a burst begins again at 0.
// Bit-accurate model: models/tactile_depth/chip/common/td_burst_counter.py.

`default_nettype none

module td_burst_counter #(
  parameter int Words = 128,
  localparam int PositionWidth = $clog2(Words)
) (
  input  wire                      clk,
  input  wire                      rst,
  input  wire                      en,
  input  wire                      start,
  output logic [PositionWidth-1:0] position,
  output logic                     active    // a word of a burst is present
);

  logic [PositionWidth-1:0] count;
  logic running;

  assign position = start ? '0 : count;
  assign active = start | running;

  always_ff @(posedge clk) begin
    if (en && active) begin
      count <= position + PositionWidth'(1);
      running <= position != PositionWidth'(Words - 1);
    end
    if (rst) begin
      count <= '0;
      running <= 1'b0;
    end
  end

  if (Words < 2) begin : g_refused
    Words_must_be_at_least_2 u_refused ();
  end

endmodule

`default_nettype wire
