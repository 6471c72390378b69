// SPDX-License-Identifier: Apache-2.0
// packet_mux: packets of four streams into one, a whole packet at a time.
//
// A packet is chosen as it begins, among those that are offered: status, then reply, then record, then depth. If a
// record was chosen after the last packet of depth, depth goes before the next record.
// Streams in, stream out: bytes under valid and ready, last with the last of a packet; what is offered stays until it
// is taken. Latency: 1 cycle to choose, in which nothing is offered; then bytes pass without a register.
// Cycle-accurate model: models/tactile_depth/chip/link/packet_mux.py.

`default_nettype none

module packet_mux (
  input  wire         clk,
  input  wire         rst,
  input  wire         status_valid,
  output logic        status_ready,
  input  wire  [7:0]  status_data,
  input  wire         status_last,
  input  wire         reply_valid,
  output logic        reply_ready,
  input  wire  [7:0]  reply_data,
  input  wire         reply_last,
  input  wire         record_valid,
  output logic        record_ready,
  input  wire  [7:0]  record_data,
  input  wire         record_last,
  input  wire         depth_valid,
  output logic        depth_ready,
  input  wire  [7:0]  depth_data,
  input  wire         depth_last,
  output logic        out_valid,
  input  wire         out_ready,
  output logic [7:0]  out_data,
  output logic        out_last
);

  typedef enum logic [1:0] {Status, Reply, Record, Depth} source_e;

  source_e first, chosen;  // of those that are offered; of the packet that passes
  logic passes, depth_is_next;
  logic [3:0] valid, last;
  logic [31:0] data;
  assign valid = {depth_valid, record_valid, reply_valid, status_valid};
  assign last = {depth_last, record_last, reply_last, status_last};
  assign data = {depth_data, record_data, reply_data, status_data};

  always_comb begin
    if (status_valid) first = Status;
    else if (reply_valid) first = Reply;
    else if (record_valid && !(depth_valid && depth_is_next)) first = Record;
    else first = Depth;
  end

  assign out_valid = passes & valid[chosen];
  assign out_data = 8'(data >> {chosen, 3'd0});
  assign out_last = last[chosen];
  assign {depth_ready, record_ready, reply_ready, status_ready} = {3'd0, passes & out_ready} << chosen;

  always_ff @(posedge clk) begin
    if (!passes) begin
      chosen <= first;
      passes <= valid != '0;
      if (valid != '0 && first == Record) depth_is_next <= 1'b1;
      if (valid != '0 && first == Depth) depth_is_next <= 1'b0;
    end else if (out_valid && out_ready && out_last) begin
      passes <= 1'b0;
    end
    if (rst) begin
      passes <= 1'b0;
      depth_is_next <= 1'b0;
    end
  end

endmodule

`default_nettype wire
