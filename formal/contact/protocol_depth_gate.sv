// SPDX-License-Identifier: Apache-2.0
// protocol_depth_gate: frames of any number of words, in successive enabled clocks; after a reset the first word is a
// frame's first, in a reset too. A word stays while en is low.

`default_nettype none

module protocol_depth_gate #(
  parameter int Width = 24
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic             in_valid,
  input  logic [2:0]       in_position,  // frame_start, row_end, frame_end
  input  logic [Width-1:0] in_data,
  input  logic             m_valid,
  input  logic             tap_valid,
  output logic             holds,
  output logic             counts_m_position,
  output logic             counts_m_data,
  output logic             counts_tap_position,
  output logic             counts_tap_data,
  output logic             counts
);

  logic reset, live = 1'b0, open = 1'b0, stays = 1'b0;
  logic [Width+2:0] word, word_before;
  assign reset = rst | ~holds;
  assign word = {in_position, in_data};
  assign holds = (in_valid | ~open) & (~in_valid | in_position[2] == ~open)
      & (~stays | (in_valid & word == word_before));
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (reset) open <= 1'b0;
    else if (en && in_valid) open <= ~in_position[0];
    stays <= in_valid & ~en & ~reset;
    word_before <= word;
  end
  assign counts = live & ~reset;
  assign {counts_m_position, counts_m_data} = {2{counts & m_valid}};
  assign {counts_tap_position, counts_tap_data} = {2{counts & tap_valid}};

endmodule

`default_nettype wire
