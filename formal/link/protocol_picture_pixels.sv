// SPDX-License-Identifier: Apache-2.0
// protocol_picture_pixels: packets of any length, a byte at least; a byte that is offered stays until it is taken. A
// pixel counts while it is valid.

`default_nettype none

module protocol_picture_pixels (
  input  logic       clk,
  input  logic       rst,
  input  logic       picture_valid,
  input  logic       picture_ready,
  input  logic [7:0] picture_data,
  input  logic       picture_last,
  input  logic       m_axis_tvalid,
  output logic       holds,
  output logic       counts_m_axis_tdata,
  output logic       counts_m_axis_tlast,
  output logic       counts_m_axis_tuser,
  output logic       counts
);

  logic reset, live = 1'b0;
  assign reset = rst | ~holds;
  always_ff @(posedge clk) live <= live | reset;
  offer_stays #(.Width(9)) u_picture (
    .clk, .rst, .reset, .valid(picture_valid), .ready(picture_ready), .word({picture_last, picture_data}), .holds
  );
  assign counts = live & ~reset;
  assign {counts_m_axis_tdata, counts_m_axis_tlast, counts_m_axis_tuser} = {3{counts & m_axis_tvalid}};

endmodule

`default_nettype wire
