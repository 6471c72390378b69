// SPDX-License-Identifier: Apache-2.0
// protocol_depth_packets: shifts up to 16; `resets` stands while a frame is sent; a cold reset comes with a reset. Bytes
// count while they are valid, an address with its read, a word of the record behind the 18 bytes in front of it.

`default_nettype none

module protocol_depth_packets (
  input  logic        clk,
  input  logic        rst,
  input  logic        cold_rst,
  input  logic [4:0]  shift,
  input  logic [15:0] resets,
  input  logic        value_read,
  input  logic        depth_valid,
  input  logic        depth_ready,
  input  logic [7:0]  depth_data,
  input  logic        depth_last,
  input  logic        sending,
  output logic        holds,
  output logic        counts_value_address,
  output logic        counts_record_word,
  output logic        counts_depth_data,
  output logic        counts_depth_last,
  output logic        counts
);

  logic live = 1'b0, was_sending = 1'b0, trailer = 1'b0;
  logic [4:0] bytes = '0;  // of the packet that were taken, up to 18
  logic [15:0] resets_q;
  assign holds = shift <= 5'd16 & (~cold_rst | rst) & (rst | ~was_sending | ~sending | resets == resets_q);
  assign counts = live & ~rst & holds;
  assign counts_value_address = counts & value_read;
  assign {counts_depth_data, counts_depth_last} = {2{counts & depth_valid}};
  assign counts_record_word = counts & sending & trailer & bytes == 5'd18;
  always_ff @(posedge clk) begin
    live <= live | rst | ~holds;
    was_sending <= sending & ~rst & holds;
    resets_q <= resets;
    if (depth_valid && depth_ready) begin
      if (bytes == '0) trailer <= depth_data == 8'h98;
      if (depth_last) bytes <= '0;
      else if (bytes != 5'd18) bytes <= bytes + 5'd1;
    end
    if (rst || !holds) bytes <= '0;
  end

endmodule

`default_nettype wire
