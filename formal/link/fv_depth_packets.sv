// SPDX-License-Identifier: Apache-2.0
// fv_depth_packets: a frame is taken as soon as it can be, with its format; then each byte is that of docs/link.md: kind,
// number and position, Values values in a packet, those that are left in the last one, and the trailer with the CRC over
// the bytes of values and with the record. Reads are those of the value, each once; done comes with the last byte. Bytes
// are stable under stall, and none is more than 9 clocks late. `sent` is cleared by a cold reset alone.
//
// The value at an arbitrary address is any constant, and so is one bit of an arbitrary byte of the record. 16-bit values
// are compared with a depth_value of the bench, which takes what was read.

parameter int Rows = 3, Columns = 2, DataWidth = 10, BottomFirst = 1, Values = 2;
input logic [PlaceWidth-1:0] pick;
input logic signed [DataWidth-1:0] pick_value;
input logic [5:0] pick_byte;
input logic pick_bit;

// The store: what it answers.
logic [PlaceWidth-1:0] watched;
logic signed [DataWidth-1:0] watched_value, value_q;
logic [5:0] watched_byte;
logic [3:0] word_q, word_q2;
logic [31:0] record_q;
logic watched_bit, read_q, read_q2, read_q3, read_watched_q, read_watched_q2, read_watched_q3, word_watched_q;
offer_stays u_depth_ (.*);
always_comb begin
  assume (read_q3 || value_data == value_q);
  assume (word_q != word_q2 || record_data == record_q);
  if (read_watched_q3) assume (value_data == watched_value);
  if (word_watched_q) assume (record_data[{watched_byte[1:0], 3'd0}] == watched_bit);
  assume (pick_byte < 6'd60);
end
always_ff @(posedge clk) begin
  if (!started) {watched, watched_value, watched_byte, watched_bit} <= {pick, pick_value, pick_byte, pick_bit};
  value_q <= value_data;
  {word_q, word_q2, record_q} <= {record_word, word_q, record_data};
  {read_q, read_q2, read_q3} <= rst ? '0 : {value_read, read_q, read_q2};
  {read_watched_q, read_watched_q2, read_watched_q3} <=
      {value_read & value_address == watched, read_watched_q, read_watched_q2};
  word_watched_q <= record_word == watched_byte[5:2];
end

// Where in the frame the next byte is.
logic [1:0] kind;      // the format
logic [4:0] kept_shift;
logic busy, trailer;
logic [6:0] at;        // in the packet
logic [31:0] number = '0;
logic [31:0] dut_crc;  // with the byte that is not in it yet
assign dut_crc = dut.counts ? crc32_step(dut.crc, dut.counted) : dut.crc;
logic [31:0] crc;
logic [7:0] index;     // of the next value; values of its packet that came before it
logic [7:0] in_packet;
logic [15:0] row, column;  // of the next value
logic [2:0] reads;     // of this value
logic [1:0] size, byte_of_value;
logic [7:0] count;
logic [15:0] rows, columns;
logic leaves, value_ends, packet_ends;
assign leaves = depth_valid & depth_ready;
assign size = kind == 2'd1 ? 2'((DataWidth + 7) / 8) : 2'd2;
assign rows = kind == 2'd3 ? 16'(Rows / 2) : 16'(Rows);
assign columns = kind == 2'd3 ? 16'(Columns / 2) : 16'(Columns);
assign count = kind == 2'd3 ? 8'((Rows / 2) * (Columns / 2)) : 8'(Rows * Columns);
assign value_ends = ~trailer & at >= 7'd9 & byte_of_value == size - 2'd1;
assign packet_ends = trailer ? at == 7'd77
    : value_ends & (in_packet == 8'(Values - 1) | index == count - 8'd1);

logic signed [15:0] reference;
logic [1:0] since;  // clocks since the last code of the reference, up to 2
logic [2:0] codes;
depth_value #(.DataWidth(DataWidth)) u_reference (
  .clk, .average(kind == 2'd3), .shift(kept_shift), .in_valid(read_q3), .in_first(codes == '0),
  .in_code(value_data), .value(reference)
);

logic ended;  // the last byte of a frame left in the clock before
always_ff @(posedge clk) begin
  ended <= ~rst & leaves & packet_ends & trailer;
  since <= read_q3 ? '0 : since + 2'(since != 2'd2);
  if (read_q3) codes <= codes + 3'd1;
  if (value_read) reads <= reads + 3'd1;
  if (leaves) begin
    at <= packet_ends ? '0 : at + 7'd1;
    if (!trailer && at >= 7'd9) begin
      crc <= crc32_step(crc, depth_data);
      byte_of_value <= value_ends ? '0 : byte_of_value + 2'd1;
    end
    if (value_ends) begin
      index <= index + 8'd1;
      in_packet <= packet_ends ? '0 : in_packet + 8'd1;
      column <= column == columns - 16'd1 ? '0 : column + 16'd1;
      row <= column == columns - 16'd1 ? row + 16'd1 : row;
      trailer <= index == count - 8'd1;
      {reads, codes} <= '0;
    end
    if (packet_ends && trailer) busy <= 1'b0;
  end
  if (frame_take) begin
    busy <= 1'b1;
    trailer <= 1'b0;
    {at, index, in_packet, row, column, reads, codes, byte_of_value} <= '0;
    crc <= CrcStart;
    kind <= format;
    kept_shift <= format == 2'd1 ? '0 : shift;
  end
  if (cold_rst) number <= '0;
  else if (frame_take && !rst) number <= number + 32'd1;
  if (rst) busy <= 1'b0;
end

// The byte.
logic [143:0] head;
logic [31:0] wide;
logic [15:0] read_row, read_column;
assign head = trailer
    ? {~crc, 8'(BottomFirst), columns, rows, 3'd0, kept_shift, 6'd0, kind, resets, number, 8'h98}
    : {72'd0, column, row, number, 6'b100100, kind};
assign wide = 32'(watched_value);
assign read_row = kind == 2'd3 ? 2 * row + 16'(reads[1]) : row;
assign read_column = kind == 2'd3 ? 2 * column + 16'(reads[0]) : column;

logic was_reset;
logic [3:0] silent;
always_ff @(posedge clk) begin
  was_reset <= rst;
  silent <= depth_valid | ~sending | rst ? '0 : silent + 4'd1;
end

logic [PlaceWidth-1:0] value_address_q;
always_ff @(posedge clk) if (value_read) value_address_q <= value_address;

// Behind the proof: the core is where the bench is.
logic head_phase, load_phase, value_phase, tail_phase;
logic [5:0] step, codes_due, reads_due, all;  // in Load: the clock, codes and reads until now; those of a value
assign head_phase = dut.phase == 2'd0;
assign load_phase = dut.phase == 2'd1;
assign value_phase = dut.phase == 2'd2;
assign tail_phase = dut.phase == 2'd3;
assign step = dut.at;
assign all = kind == 2'd3 ? 6'd4 : 6'd1;
assign reads_due = step < all ? step : all;
assign codes_due = step < 6'd3 ? '0 : step - 6'd3 < all ? step - 6'd3 : all;
always_comb begin
  if (started && !rst) begin
    if (!busy || head_phase || tail_phase) no_reads: assert (!read_q && !read_q2 && !read_q3);
    if (busy) begin
      same_frame: assert (dut.kept_format == kind && kind != 2'd0 && dut.kept_shift == kept_shift && dut_crc == crc);
      same_part: assert (dut.trailer == trailer && (trailer ? head_phase | tail_phase : !tail_phase));
      same_end: assert (dut.last_at == (head_phase ? (trailer ? 6'd17 : 6'd8) : tail_phase ? 6'd59
          : load_phase ? all + 6'd4 : 6'(size) - 6'd1));
      if (trailer) all_sent: assert (index == count && in_packet == '0);
      else same_value: assert (index < count && 8'(dut.place) == index && in_packet == index % 8'(Values));
      same_place: assert ((kind == 2'd3 ? row * 16'(Columns / 2) : row * 16'(Columns)) + column == 16'(index)
          && column < columns && row <= rows);
      if (head_phase) begin
        same_byte: assert (7'(step) == at && at < (trailer ? 7'd18 : 7'd9) && !dut.stale);
        packet_begins: assert (in_packet == '0 && silent == '0);
      end
      if (tail_phase) begin
        same_byte_of_record: assert (7'(step) + 7'd18 == at && at <= 7'd77 && silent <= 4'(!dut.stale));
        if (!dut.stale) same_word: assert (word_q == record_word && word_watched_q == (word_q == watched_byte[5:2]));
      end
      if (load_phase) begin
        nothing_sent: assert (at >= 7'd9 && byte_of_value == '0 && !dut.stale && 6'(silent) == step);
        till_now: assert (6'(reads) == reads_due && 6'(codes) == codes_due && step <= all + 6'd4);
        read_before: assert (read_q == (step >= 6'd1 && step <= all));
        read_before_that: assert (read_q2 == (step >= 6'd2 && step <= all + 6'd1));
        read_first: assert (read_q3 == (step >= 6'd3 && step <= all + 6'd2));
        if (step >= all + 6'd3) settles: assert (6'(since) == step - all - 6'd3);
      end
      if (value_phase) begin
        some_sent: assert (at >= 7'd9 && step == 6'(byte_of_value) && byte_of_value < size && !dut.stale);
        settled: assert (!read_q && !read_q2 && !read_q3 && since == 2'd2 && codes == reads && 6'(reads) == all && silent <= 4'd9);
      end
      if (load_phase || value_phase) begin
        so_far: assert (at == 7'd9 + 7'(in_packet) * 7'(size) + 7'(byte_of_value));
        if (codes != '0) same_sum: assert (dut.u_value.sum == u_reference.sum);
        if (6'(codes) == all && since != '0) begin
          same_quotient: assert (dut.u_value.whole == u_reference.whole && dut.u_value.up == u_reference.up);
        end
        if (kind == 2'd1) begin
          if (reads != '0) same_address: assert (value_address_q == dut.place);
          watched_before: assert (read_watched_q == (read_q && value_address_q == watched));
          watched_before_that: assert (read_watched_q2 == (read_q2 && value_address_q == watched));
          watched_first: assert (read_watched_q3 == (read_q3 && value_address_q == watched));
          if (codes != '0 && value_address_q == watched) same_code: assert (value_q == watched_value);
        end
      end else begin
        none_read: assert (reads == '0 && codes == '0 && byte_of_value == '0);
      end
    end
  end
end

always_comb begin
  numbered: assert (sent == number);
  if (started && !rst) begin
    if (was_reset) quiet: assert (!sending);
    taken: assert (sending == busy && frame_take == (~busy & ~ended & frame_valid & format != 2'd0));
    if (!busy) none: assert (!depth_valid && !value_read);
    given_back: assert (frame_done == ended);
    if (value_read) begin
      own: assert (!trailer && at >= 7'd9 && byte_of_value == '0 && reads < (kind == 2'd3 ? 3'd4 : 3'd1));
      place: assert (32'(value_address) == 32'(read_row) * Columns + 32'(read_column));
    end
    in_time: assert (silent <= 4'd9);
    if (depth_valid) begin
      ends: assert (depth_last == packet_ends);
      if (at < (trailer ? 7'd18 : 7'd9)) fields: assert (depth_data == 8'(head >> {at, 3'd0}));
      else if (!trailer) begin
        all_read: assert (reads == (kind == 2'd3 ? 3'd4 : 3'd1));
        if (kind != 2'd1) begin
          short_value: assert (since == 2'd2 && codes == reads
              && depth_data == (byte_of_value == '0 ? reference[7:0] : reference[15:8]));
        end else if (value_address_q == watched) begin
          word: assert (depth_data == 8'(wide >> {byte_of_value, 3'd0}));
        end
      end else if (at == 7'd18 + 7'(watched_byte)) begin
        of_record: assert (depth_data[0] == watched_bit);
      end
    end
    second_packet: cover (depth_valid && in_packet == '0 && index != '0 && at == 7'd3);
    mean: cover (depth_valid && kind == 2'd3 && at == 7'd10);
  end
end

// Protocol: shifts up to 16; `resets` stands while a frame is sent; a cold reset comes with a reset; a value stands but in
// the third clock behind a read, and a word of the record until the next one is asked for. Bytes count while they are
// valid, an address with its read, a word of the record behind the 18 bytes in front of it.
module protocol_depth_packets;
  logic was_sending = 1'b0, trailer = 1'b0;
  logic [4:0] bytes = '0;  // of the packet that were taken, up to 18
  logic [15:0] resets_q;
  logic [2:0] read_q;
  logic [1:0][$bits(record_word)-1:0] word_q;
  logic [$bits(value_data)-1:0] value_q;
  logic [$bits(record_data)-1:0] record_q;
  assign given_value_data = read_q[2] ? value_data : value_q;
  assign given_record_data = word_q[0] != word_q[1] ? record_data : record_q;
  assign holds = shift <= 5'd16 & (~cold_rst | rst) & (rst | ~was_sending | ~sending | resets == resets_q);
  assign counts = live & ~reset;
  assign counts_value_address = counts & value_read;
  assign {counts_depth_data, counts_depth_last} = {2{counts & depth_valid}};
  assign counts_record_word = counts & sending & trailer & bytes == 5'd18;
  always_ff @(posedge clk) begin
    was_sending <= sending & ~reset;
    resets_q <= resets;
    read_q <= {read_q[1:0], value_read & ~reset};
    word_q <= {word_q[0], record_word};
    {value_q, record_q} <= {given_value_data, given_record_data};
    if (depth_valid && depth_ready) begin
      if (bytes == '0) trailer <= depth_data == 8'h98;
      if (depth_last) bytes <= '0;
      else if (bytes != 5'd18) bytes <= bytes + 5'd1;
    end
    if (reset) bytes <= '0;
  end
endmodule
