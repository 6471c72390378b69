// SPDX-License-Identifier: Apache-2.0
// protocol_packet_decode: packets as they leave packet_store. A byte that was not taken is offered again; a packet has
// 1 to 2047 bytes, the same length with each, and ends with the last of them, with that of a full bank, or where the
// core drops it. What is offered counts while it is valid.

`default_nettype none

module protocol_packet_decode (
  input  logic        clk,
  input  logic        rst,
  input  logic        in_valid,
  input  logic        in_ready,
  input  logic [7:0]  in_data,
  input  logic        in_last,
  input  logic        in_drop,
  input  logic [10:0] in_length,
  input  logic [1:0]  in_length_mod3,
  input  logic        select,
  input  logic        request_valid,
  input  logic        picture_valid,
  output logic [10:0] place,          // of the byte in its packet
  output logic        holds,
  output logic        counts_in_ready,
  output logic        counts_in_drop,
  output logic        counts_select_format,
  output logic        counts_select_shift,
  output logic        counts_request_data,
  output logic        counts_request_last,
  output logic        counts_request_write,
  output logic        counts_picture_data,
  output logic        counts_picture_last,
  output logic        counts
);

  localparam logic [10:0] BankBytes = 11'd1024;

  logic live = 1'b0, reset, stays, consistent;
  logic [10:0] at = '0, length, end_at;
  assign place = at;
  assign reset = rst | ~holds;
  offer_stays #(.Width(22)) u_offer (
    .clk, .rst, .reset, .valid(in_valid), .ready(in_ready), .word({in_data, in_last, in_length, in_length_mod3}),
    .holds(stays)
  );
  assign end_at = in_length < BankBytes ? in_length : BankBytes;
  assign consistent = (in_length != '0) & (at == '0 | in_length == length) & (in_length_mod3 == 2'(in_length % 11'd3))
      & (in_last == (at + 11'd1 == end_at));
  assign holds = stays & (~in_valid | consistent);
  assign counts = live;
  assign counts_in_ready = live & in_valid;
  assign counts_in_drop = live & in_valid & in_ready & ~rst;
  assign {counts_select_format, counts_select_shift} = {2{live & select}};
  assign {counts_request_data, counts_request_last, counts_request_write} = {3{live & request_valid}};
  assign {counts_picture_data, counts_picture_last} = {2{live & picture_valid}};

  always_ff @(posedge clk) begin
    live <= live | reset;
    if (in_valid && in_ready) begin
      at <= in_last | in_drop ? '0 : at + 11'd1;
      length <= in_length;
    end
    if (reset) at <= '0;
  end

endmodule

`default_nettype wire
