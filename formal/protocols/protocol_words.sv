// SPDX-License-Identifier: Apache-2.0
// protocol_words: single words going in, bursts of Columns words going out, Lanes words in a clock.
//
// A frame begins with in_frame_start. It has Rows times Columns words, and the next begins after it is whole; a frame
// may begin at any word if Rows is 0.

`default_nettype none

module protocol_words #(
  parameter int Columns = 8,
  parameter int Rows    = 0,
  parameter int Lanes   = 1
) (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic in_valid,
  input  logic in_frame_start,
  input  logic out_start,
  output logic holds,
  output logic counts_out_start,
  output logic counts_out_frame_start,
  output logic counts_saturations,
  output logic counts
);

  logic reset, live = 1'b0, begun = 1'b0;
  logic [23:0] left = '0;  // words of the frame to come
  logic [15:0] out_left = '0;
  assign reset = rst | ~holds;
  assign holds = (~in_frame_start | in_valid)
      & (~in_valid | rst | in_frame_start | (Rows == 0 ? begun : left != '0))
      & (~in_frame_start | Rows == 0 | left == '0);
  assign counts_out_start = live & ~reset & en;
  assign counts_out_frame_start = counts_out_start;
  assign counts_saturations = live & ~reset;
  assign counts = counts_out_start & (out_start | out_left != '0);

  always_ff @(posedge clk) begin
    live <= live | reset;
    if (en) begin
      if (in_valid) begin
        begun <= 1'b1;
        left <= in_frame_start ? 24'(Columns * Rows - 1) : left - 24'd1;
      end
      out_left <= out_start ? 16'(Columns / Lanes - 1) : out_left - 16'(out_left != '0);
    end
    if (reset) begin
      begun <= 1'b0;
      left <= '0;
      out_left <= '0;
    end
  end

endmodule

`default_nettype wire
