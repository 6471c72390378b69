// SPDX-License-Identifier: Apache-2.0
// protocol_contact_events: rows of Columns depths, Rows of them in a frame.
//
// A frame may begin inside another; none but the first after a reset may lack its start.

module protocol_contact_events #(
  parameter int Rows    = 128,
  parameter int Columns = 128
) (
  input  logic clk,
  input  logic rst,
  input  logic in_valid,
  input  logic in_user,
  input  logic in_last,
  input  logic in_frame_end,
  input  logic m_event_tvalid,
  output logic holds,
  output logic counts_m_event_tdata,
  output logic counts_m_event_tlast,
  output logic counts
);

  logic reset, live = 1'b0;
  logic [15:0] next_place = '0, next_column = '0;  // of the next depth; place 0: the first of a frame
  logic [15:0] place, column;
  assign reset = rst | ~holds;
  assign place = in_user ? '0 : next_place;
  assign column = in_user ? '0 : next_column;
  assign holds = ~in_valid | rst | ((in_user | next_place != '0)
      & (in_last == (column == 16'(Columns - 1))) & (in_frame_end == (place == 16'(Rows * Columns - 1))));
  assign counts = live & ~reset;
  assign {counts_m_event_tdata, counts_m_event_tlast} = {2{counts & m_event_tvalid}};
  always_ff @(posedge clk) begin
    live <= live | reset;
    if (reset) begin
      next_place <= '0;
    end else if (in_valid) begin
      next_place <= in_frame_end ? '0 : place + 16'd1;
      next_column <= in_last ? '0 : column + 16'd1;
    end
  end

endmodule
