// SPDX-License-Identifier: Apache-2.0
// record_packets: keeps the newest record, and sends each as a packet of words.
//
// Stream out: packets of Words words under valid and ready, word 0 first, tlast with the last. A record that finds the
// one before still waiting for its turn replaces it, and record_lost is high for one cycle; a packet that has begun is
// finished. Latency: the record is in its register 1 cycle after new_valid, its packet begins 1 cycle later.
// Cycle-accurate model: models/tactile_depth/chip/contact/record_packets.py.

`default_nettype none

module record_packets #(
  parameter int Words = td_register_map_pkg::RecordWords
) (
  input  wire                  clk,
  input  wire                  rst,
  input  wire                  new_valid,
  input  wire  [32*Words-1:0]  new_record,      // word n in bits 32 n + 31 to 32 n
  output logic                 record_valid,    // the record is new in this cycle
  output logic [32*Words-1:0]  record,          // zero after a reset
  output logic                 record_lost,     // a record was replaced before it was sent
  output logic [31:0]          m_event_tdata,
  output logic                 m_event_tvalid,
  input  wire                  m_event_tready,
  output logic                 m_event_tlast
);

  localparam int WordWidth = $clog2(Words);

  logic waiting, begins, leaves, packet_ends;
  logic [32*Words-1:0] packet;
  logic [WordWidth-1:0] word;
  logic [(1<<WordWidth)-1:0][31:0] words;  // one for each number
  assign words = (32 << WordWidth)'(packet);
  assign leaves = m_event_tvalid & m_event_tready;
  assign packet_ends = leaves & m_event_tlast;
  assign begins = waiting & (~m_event_tvalid | packet_ends);
  assign m_event_tdata = words[word];
  assign m_event_tlast = word == WordWidth'(Words - 1);
  assign record_lost = new_valid & waiting & ~begins;

  always_ff @(posedge clk) begin
    record_valid <= new_valid;
    if (new_valid) record <= new_record;
    waiting <= new_valid | (waiting & ~begins);
    if (begins) packet <= record;
    if (begins) word <= '0;
    else if (leaves) word <= word + WordWidth'(1);
    m_event_tvalid <= begins | (m_event_tvalid & ~packet_ends);
    if (rst) begin
      record_valid <= 1'b0;
      record <= '0;
      waiting <= 1'b0;
      m_event_tvalid <= 1'b0;
    end
  end

endmodule

`default_nettype wire
