// SPDX-License-Identifier: Apache-2.0
// protocol_camera_front_end: the source keeps to AXI4-Stream; any pictures, whole or broken, and any settings. Colours
// count in no word that ends a frame before its end, which frame_guard drops.

module protocol_camera_front_end;
  logic word;
  logic [15:0] column = '0;
  axis_source #(.Width(26)) u_source (
    .clk, .rst, .reset, .valid(s_axis_tvalid), .ready(s_axis_tready),
    .word({s_axis_tuser, s_axis_tlast, s_axis_tdata}), .holds
  );
  always_ff @(posedge clk) begin
    if (word && m_axis_tready) column <= m_axis_tlast || column == 16'(Columns - 1) ? '0 : column + 16'd1;
    if (reset) column <= '0;
  end
  assign counts = live & ~reset;
  assign word = counts & m_axis_tvalid;
  assign {counts_m_axis_tlast, counts_m_axis_tuser} = {2{word}};
  assign counts_m_axis_tdata = word & m_axis_tlast == (column == 16'(Columns - 1));
endmodule
