// SPDX-License-Identifier: Apache-2.0
// packet_store: keeps packets until they are known to be good, two at most, and gives them on with their length.
//
// Bytes in, then in_end without a byte. A packet goes into a free bank; a good one has 1 to 2047 bytes, of which the
// first BankBytes are kept. in_ready is low while both banks hold packets. A source may ignore that: a packet that
// sends a byte then is lost. Stream out: the kept bytes of each good packet in order under valid and ready, out_last
// with the last; out_length and out_length_mod3 are the true length, all through the packet. A byte that is taken with
// out_drop takes the rest of its packet with it. A bank is free behind the last byte. `bad` is high for one clock for
// a packet that is bad or lost. Latency: 3 cycles from in_end to the first byte, 1 to `bad`; a byte every 3 cycles.
// Model: models/tactile_depth/chip/link/packet_store.py.

`default_nettype none

module packet_store #(
  parameter int BankBytes = 1024  // a power of two, 4 to 1024
) (
  input  wire         clk,
  input  wire         rst,
  input  wire         in_valid,
  input  wire  [7:0]  in_data,
  input  wire         in_end,           // without in_valid
  input  wire         in_good,          // counts with in_end
  output logic        in_ready,
  output logic        bad,
  output logic        out_valid,
  input  wire         out_ready,
  output logic [7:0]  out_data,
  output logic        out_last,
  input  wire         out_drop,         // counts when a byte is taken
  output logic [10:0] out_length,
  output logic [1:0]  out_length_mod3
);

  localparam int PlaceWidth = $clog2(BankBytes);
  localparam logic [10:0] Most = 11'(BankBytes);

  // Packets that were stored, and that left, both modulo 4: the lowest bit is the bank of the next.
  logic [1:0] stored, gone;
  logic waits, stores, goes, takes;
  assign in_ready = (stored ^ gone) != 2'd2;
  assign waits = stored != gone;

  logic [10:0] length;  // bytes that came of the packet that is written
  logic [1:0] length_mod3;
  logic lost, has_room;
  assign has_room = in_ready & (length < Most);
  assign stores = in_end & in_good & ~lost;

  logic [1:0][12:0] lengths;  // of the packets in the banks
  logic [PlaceWidth-1:0] place;  // of the byte that is read
  logic [11:0] next_place;
  logic fetch, fetched;
  logic [7:0] read_data;
  logic [10:0] read_length;  // of its packet
  logic [1:0] read_mod3;
  assign {read_mod3, read_length} = gone[0] ? lengths[1] : lengths[0];
  assign next_place = 12'(place) + 12'd1;
  assign takes = out_valid & out_ready;
  assign goes = takes & (out_last | out_drop);
  assign fetch = waits & ~fetched & ~out_valid;

  td_ram #(.Width(8), .Depth(2 * BankBytes)) u_bytes (
    .clk,
    .write_en(in_valid & has_room), .write_address({stored[0], length[PlaceWidth-1:0]}), .write_data(in_data),
    .read_en(fetch), .read_address({gone[0], place}), .read_data
  );

  always_ff @(posedge clk) begin
    bad <= in_end & ~stores;
    if (stores && !stored[0]) lengths[0] <= {length_mod3, length};
    if (stores && stored[0]) lengths[1] <= {length_mod3, length};
    if (in_valid) begin
      length <= length + 11'd1;
      length_mod3 <= length_mod3 == 2'd2 ? 2'd0 : length_mod3 + 2'd1;
      lost <= lost | ~in_ready;
    end
    fetched <= fetch;
    if (fetched) begin
      out_data <= read_data;
      out_last <= (next_place == 12'(Most)) | (next_place == 12'(read_length));
      out_length <= read_length;
      out_length_mod3 <= read_mod3;
    end
    out_valid <= fetched | (out_valid & ~out_ready);
    if (takes) place <= place + PlaceWidth'(1);
    stored <= stored + 2'(stores);
    gone <= gone + 2'(goes);
    if (in_end || rst) begin
      length <= '0;
      length_mod3 <= '0;
      lost <= 1'b0;
    end
    if (goes || rst) place <= '0;
    if (rst) begin
      bad <= 1'b0;
      fetched <= 1'b0;
      out_valid <= 1'b0;
      stored <= '0;
      gone <= '0;
    end
  end

endmodule

`default_nettype wire
