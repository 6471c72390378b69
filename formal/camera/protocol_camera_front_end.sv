// SPDX-License-Identifier: Apache-2.0
// protocol_camera_front_end: the source keeps to AXI4-Stream; any pictures, whole or broken, and any settings. Colours
// count in no word that ends a frame before its end, which frame_guard drops.

`default_nettype none

module protocol_camera_front_end #(
  parameter int Columns = 128
) (
  input  logic        clk,
  input  logic        rst,
  input  logic        s_axis_tvalid,
  input  logic        s_axis_tready,
  input  logic [23:0] s_axis_tdata,
  input  logic        s_axis_tlast,
  input  logic        s_axis_tuser,
  input  logic        m_axis_tvalid,
  input  logic        m_axis_tready,
  input  logic        m_axis_tlast,
  output logic        holds,
  output logic        counts_m_axis_tdata,
  output logic        counts_m_axis_tlast,
  output logic        counts_m_axis_tuser,
  output logic        counts
);

  logic reset, live = 1'b0, word;
  logic [15:0] column = '0;
  assign reset = rst | ~holds;
  axis_source #(.Width(26)) u_source (
    .*, .valid(s_axis_tvalid), .ready(s_axis_tready), .word({s_axis_tuser, s_axis_tlast, s_axis_tdata})
  );
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (word && m_axis_tready) column <= m_axis_tlast || column == 16'(Columns - 1) ? '0 : column + 16'd1;
    if (reset) column <= '0;
  end
  assign counts = live & ~reset;
  assign word = counts & m_axis_tvalid;
  assign {counts_m_axis_tlast, counts_m_axis_tuser} = {2{word}};
  assign counts_m_axis_tdata = word & m_axis_tlast == (column == 16'(Columns - 1));

endmodule

`default_nettype wire
