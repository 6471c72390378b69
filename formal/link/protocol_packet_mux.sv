// SPDX-License-Identifier: Apache-2.0
// protocol_packet_mux: a byte that is offered stays until it is taken; bytes that leave count while they are valid.

`default_nettype none

module protocol_packet_mux (
  input  logic       clk,
  input  logic       rst,
  input  logic       status_valid,
  input  logic       status_ready,
  input  logic [7:0] status_data,
  input  logic       status_last,
  input  logic       reply_valid,
  input  logic       reply_ready,
  input  logic [7:0] reply_data,
  input  logic       reply_last,
  input  logic       record_valid,
  input  logic       record_ready,
  input  logic [7:0] record_data,
  input  logic       record_last,
  input  logic       depth_valid,
  input  logic       depth_ready,
  input  logic [7:0] depth_data,
  input  logic       depth_last,
  input  logic       out_valid,
  output logic       holds,
  output logic       counts_out_data,
  output logic       counts_out_last,
  output logic       counts
);

  logic live = 1'b0, reset;
  logic [3:0] stay;
  assign holds = &stay;
  assign reset = rst | ~holds;
  offer_stays #(.Width(9)) u_status (
    .clk, .rst, .reset, .valid(status_valid), .ready(status_ready), .word({status_last, status_data}), .holds(stay[0])
  );
  offer_stays #(.Width(9)) u_reply (
    .clk, .rst, .reset, .valid(reply_valid), .ready(reply_ready), .word({reply_last, reply_data}), .holds(stay[1])
  );
  offer_stays #(.Width(9)) u_record (
    .clk, .rst, .reset, .valid(record_valid), .ready(record_ready), .word({record_last, record_data}), .holds(stay[2])
  );
  offer_stays #(.Width(9)) u_depth (
    .clk, .rst, .reset, .valid(depth_valid), .ready(depth_ready), .word({depth_last, depth_data}), .holds(stay[3])
  );
  assign counts = live & ~reset;
  assign {counts_out_data, counts_out_last} = {2{counts & out_valid}};
  always_ff @(posedge clk) live <= live | reset;

endmodule

`default_nettype wire
