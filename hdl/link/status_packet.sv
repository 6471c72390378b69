// SPDX-License-Identifier: Apache-2.0
// status_packet: the packet of status, once after a reset and once for each request.
//
// A packet out, bytes under valid and ready: kind, version, fields (docs/link.md). The fields are those of the clock in
// which its first byte is taken. Requests before that clock make one packet; one in that clock, or behind it, makes
// another. Latency: the first byte is offered the clock after the request, or 2 clocks after a reset. Model: Status in
// models/tactile_depth/chip/link/packets.py.

`default_nettype none

module status_packet
  import td_link_pkg::*;
#(
  parameter int FieldBytes = 22  // fewer make a smaller core, for proofs
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     request,
  input  wire  [8*FieldBytes-1:0] fields,  // from `resets` on, in the order of the packet, the first byte lowest
  output logic                    status_valid,
  input  wire                     status_ready,
  output logic [7:0]              status_data,
  output logic                    status_last
);

  localparam int PlaceWidth = $clog2(FieldBytes + 2);

  logic due, after_reset, leaves;
  logic first;                       // the next byte is the first of a packet
  logic [PlaceWidth-1:0] place;      // of the next byte in its packet
  logic [8*FieldBytes-1:0] left;     // fields of this packet that have not left
  assign status_valid = due | ~first;
  assign status_last = place == PlaceWidth'(FieldBytes + 1);
  assign leaves = status_valid & status_ready;
  assign status_data = first ? Status : place == PlaceWidth'(1) ? Version : left[7:0];

  always_ff @(posedge clk) begin
    after_reset <= rst;
    due <= request | after_reset | (due & ~(leaves & first));
    if (leaves) begin
      first <= status_last;
      place <= status_last ? '0 : place + PlaceWidth'(1);
      if (first) left <= fields;
      else if (place != PlaceWidth'(1)) left <= left >> 8;
    end
    if (rst) begin
      {due, first} <= 2'b01;
      place <= '0;
    end
  end

endmodule

`default_nettype wire
