// SPDX-License-Identifier: Apache-2.0
// protocol_record_packet: records of 12 words; bytes count while they are valid.

`default_nettype none

module protocol_record_packet (
  input  logic       clk,
  input  logic       rst,
  input  logic       s_event_tvalid,
  input  logic       s_event_tlast,
  input  logic       record_valid,
  output logic [3:0] word,
  output logic       holds,
  output logic       counts_record_data,
  output logic       counts_record_last,
  output logic       counts
);

  logic live = 1'b0;
  logic [3:0] next_word = '0;
  assign word = next_word;
  assign holds = rst | ~s_event_tvalid | s_event_tlast == (next_word == 4'd11);
  assign counts = live & ~rst & holds;
  assign {counts_record_data, counts_record_last} = {2{counts & record_valid}};
  always_ff @(posedge clk) begin
    live <= live | rst | ~holds;
    if (s_event_tvalid) next_word <= s_event_tlast ? '0 : next_word + 4'd1;
    if (rst || !holds) next_word <= '0;
  end

endmodule

`default_nettype wire
