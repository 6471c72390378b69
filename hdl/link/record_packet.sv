// SPDX-License-Identifier: Apache-2.0
// record_packet: keeps the newest record, and sends it as a packet 0x99 (docs/link.md), without its CRC.
//
// Stream in, always taken: the words of each record, tlast with the last. Stream out: the bytes of kind and fields.
// The record is fixed when the first byte is taken; until then a newer one replaces it. One that comes while a packet
// is being sent waits for its end; the next one then replaces it as it begins. Latency: the first byte is offered in
// the clock after the last word. A byte takes a clock, and 2 more before each word. Memory: two banks. Models:
// RecordPacket in models/tactile_depth/chip/link/packets.py, models/tactile_depth/chip/link/bank_choice.py for the
// banks.

`default_nettype none

module record_packet
  import td_link_pkg::*;
  import td_register_map_pkg::RecordWords;
(
  input  wire         clk,
  input  wire         rst,
  input  wire  [31:0] s_event_tdata,
  input  wire         s_event_tvalid,
  input  wire         s_event_tlast,
  output logic        record_valid,
  input  wire         record_ready,
  output logic [7:0]  record_data,
  output logic        record_last
);

  localparam int Bytes = 4 * RecordWords;

  logic begins, ends, write_bank, waiting, take, done, reading, read_bank;
  logic [3:0] word;
  assign begins = s_event_tvalid & word == '0;
  assign ends = s_event_tvalid & s_event_tlast;
  bank_choice u_banks (
    .clk, .rst, .keep(1'b1), .write_begin(begins), .write_end(ends), .publish(ends), .write_bank, .waiting, .take,
    .done, .reading, .read_bank, .replaced()
  );

  logic read, read_q, loaded, leaves, word_ends;
  logic [5:0] place;  // of the byte in the record
  logic [31:0] bytes;
  td_ram #(.Width(32), .Depth(2 * RecordWords)) u_records (
    .clk, .write_en(s_event_tvalid), .write_address({word, write_bank}), .write_data(s_event_tdata),
    .read_en(read), .read_address({place[5:2], read_bank}), .read_data(bytes)
  );
  assign read = reading & ~loaded & ~read_q;
  assign record_valid = reading ? loaded : waiting;
  assign record_data = reading ? 8'(bytes >> {place[1:0], 3'd0}) : Record;
  assign record_last = reading & place == 6'(Bytes - 1);
  assign leaves = record_valid & record_ready;
  assign take = leaves & ~reading;
  assign word_ends = leaves & reading & place[1:0] == '1;
  assign done = leaves & record_last;

  always_ff @(posedge clk) begin
    if (s_event_tvalid) word <= s_event_tlast ? '0 : word + 4'd1;
    if (take) place <= '0;
    else if (leaves) place <= place + 6'd1;
    read_q <= read;
    loaded <= read_q | (loaded & ~word_ends);
    if (rst) {word, read_q, loaded} <= '0;
  end

endmodule

`default_nettype wire
