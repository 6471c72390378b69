// SPDX-License-Identifier: Apache-2.0
// protocol_depth_gate: frames of any number of words, in successive enabled clocks; after a reset the first word is a
// frame's first. A word stays while en is low.

module protocol_depth_gate #(
  parameter int Width = 24
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic             in_valid,
  input  logic             in_user,
  input  logic             in_last,
  input  logic             in_frame_end,
  input  logic [Width-1:0] in_data,
  input  logic             m_valid,
  input  logic             look_valid,
  output logic             holds,
  output logic             counts_m_user,
  output logic             counts_m_last,
  output logic             counts_m_frame_end,
  output logic             counts_m_data,
  output logic             counts_look_user,
  output logic             counts_look_last,
  output logic             counts_look_frame_end,
  output logic             counts_look_data,
  output logic             counts
);

  logic reset, live = 1'b0, open = 1'b0, stays = 1'b0;
  logic [Width+2:0] word, word_before;
  assign reset = rst | ~holds;
  assign word = {in_user, in_last, in_frame_end, in_data};
  assign holds = rst | ((in_valid | ~open) & (~in_valid | in_user == ~open)
      & (~stays | (in_valid & word == word_before)));
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (reset) open <= 1'b0;
    else if (en && in_valid) open <= ~in_frame_end;
    stays <= in_valid & ~en & ~reset;
    word_before <= word;
  end
  assign counts = live & ~reset;
  assign {counts_m_user, counts_m_last, counts_m_frame_end, counts_m_data} = {4{counts & m_valid}};
  assign {counts_look_user, counts_look_last, counts_look_frame_end, counts_look_data} = {4{counts & look_valid}};

endmodule
