// SPDX-License-Identifier: Apache-2.0
// fv_camera_setup: the list, and the lines.
//
// Bus 0: entries come in order; `done` means that each entry that is compared was right at last, `failed` that the entry
// it names was wrong Attempts times in a row; both stay. Pins change as their entries say, and the next entry comes after
// their milliseconds. How long a transmission takes, and what it reads, is free.
// Bus 1: a transmission is a start, the bits of its entry with a released ninth in each byte, and a stop; SIO_D changes
// while SIO_C is low, but for start and stop; each level lasts a quarter or more. A reset or restart may break it off.

parameter int Bus = 0, AddressBytes = 1, Entries = 5, QuarterClocks = 4, MillisecondClocks = 2, Attempts = 2;
localparam int DeviceId = 66, XclkHalfClocks = 2;
input logic [EntryWidth-1:0] chosen;

localparam logic [2:0] Fetch = 3'd0, Decode = 3'd1, Wait = 3'd2, Send = 3'd3;
localparam logic [1:0] VerifiedWrite = 2'd0, Pins = 2'd3;
localparam logic [1:0] Write = 2'd0, PutAddress = 2'd1, ReadBack = 2'd2;
logic started = 1'b0, fresh, fresh_q;
assign fresh = rst | restart;
always_ff @(posedge clk) begin
  started <= 1'b1;
  fresh_q <= fresh;
end
always_comb begin
  if (!started) assume (rst);
  assume (32'(chosen) < Entries);
end

if (Bus == 0) begin : g_list
  logic [EntryWidth-1:0] watched, entry_q;
  logic compares;  // the watched entry is compared: formal/tables.py
  logic right, ended, done_q, compared, agrees;
  logic [1:0] pins_q;
  logic [2:0] wrong;    // comparisons in a row
  logic [9:0] waiting;  // clocks in Wait
  logic [15:0] pair, pair_q;  // the byte on the line, and the entry's: of the clock before, as they stand for quarters
  assign pair = {dut.caught[8:1], dut.data};
  assign compares = watched == EntryWidth'(1) || 32'(watched) >= 3;
  assign compared = dut.state == Send && dut.sent && dut.step == ReadBack;
  assign agrees = dut.caught[8:1] == dut.data;

  always_ff @(posedge clk) begin
    if (!started) watched <= chosen;
    entry_q <= entry;
    ended <= (done | failed) & ~fresh;
    done_q <= done;
    pair_q <= pair;
    pins_q <= {power_down, reset_n};
    if (compared) wrong <= agrees ? '0 : wrong + 3'd1;
    if (compared && agrees && entry == watched) right <= 1'b1;
    waiting <= dut.state == Wait ? waiting + 10'd1 : '0;
    if (fresh) begin
      right <= 1'b0;
      wrong <= '0;
    end
  end

  always_comb begin
    assume (!dut.sent || (dut.sending && pair == pair_q));
    if (started) begin
      in_order: assert (fresh_q ? entry == '0 : entry == entry_q || entry == entry_q + EntryWidth'(1));
      in_list: assert (32'(entry) < Entries);
      if (ended) stays: assert (done == done_q && failed == !done_q && entry == entry_q);
      if (fresh_q) begun: assert (!done && !failed && power_down && !reset_n);
      if (compares && (done || entry > watched)) right_at_last: assert (right);
      if (failed) wrong_so_often: assert (32'(wrong) == Attempts && found != dut.data);
      if (!failed) attempts_left: assert (32'(wrong) < Attempts && 32'(wrong) == 32'(dut.attempt));
      if (!fresh_q && pins_q != {power_down, reset_n}) pins_change: assert (dut.state == Wait);
      if (dut.state == Wait) pins_of_entry: assert (dut.kind == Pins && {power_down, reset_n} == dut.address[1:0]);
      if (dut.state == Wait && dut.advance) long_enough: assert (32'(waiting) == MillisecondClocks * 32'(dut.data));
      if (dut.load && dut.load_step == Write) writes: assert (!dut.kind[1]);
      if (dut.load && dut.load_step == ReadBack) address_first: assert (dut.step == PutAddress && dut.sent);
      if (compared) not_written_unread: assert (dut.kind == VerifiedWrite || dut.kind == 2'd2);
      ends: cover (done && wrong == '0 && right);
      fails_late: cover (failed && 32'(entry) == 3);
      repeats: cover (done_q && !done);
    end
  end
end else begin : g_lines
  localparam int Longest = 18 + 9 * AddressBytes, CountWidth = $clog2(Longest + 2);
  localparam logic [7:0] Id = 8'(DeviceId);
  logic [9*AddressBytes-1:0] address;
  if (AddressBytes == 1) begin : g_one
    assign address = {dut.address[7:0], 1'b1};
  end else begin : g_two
    assign address = {dut.address[15:8], 1'b1, dut.address[7:0], 1'b1};
  end
  logic [Longest-1:0] frame;           // of the transmission under way, the first bit on top
  logic [CountWidth-1:0] bits, pulses;  // of it; of SIO_C since the start
  logic c_q, d_q, busy, expected;       // busy: between start and stop
  logic [2:0] c_since, d_since;         // clocks since the last change, QuarterClocks at most
  assign expected = frame[CountWidth'(Longest - 1) - pulses];

  always_ff @(posedge clk) begin
    c_q <= sio_c;
    d_q <= sio_d_low;
    if (dut.load) begin
      case (dut.load_step)
        Write: frame <= {Id, 1'b1, address, dut.data, 1'b1};
        PutAddress: frame <= {Id, 1'b1, address, 9'h1FF};
        default: frame <= {Id | 8'd1, 1'b1, {(Longest - 9) {1'b1}}};
      endcase
      bits <= CountWidth'(dut.load_step == Write ? 18 + 9 * AddressBytes : dut.load_step == PutAddress
          ? 9 + 9 * AddressBytes : 18);
    end
    c_since <= sio_c != c_q ? 3'd1 : c_since + 3'(32'(c_since) < QuarterClocks);
    d_since <= sio_d_low != d_q ? 3'd1 : d_since + 3'(32'(d_since) < QuarterClocks);
    if (c_q && sio_c && d_q != sio_d_low) begin
      busy <= sio_d_low;
      if (sio_d_low) pulses <= '0;
    end else if (!c_q && sio_c) begin
      pulses <= pulses + CountWidth'(1);
    end
    if (fresh || fresh_q) begin
      busy <= 1'b0;
      c_since <= 3'(QuarterClocks);
      d_since <= 3'(QuarterClocks);
      c_q <= 1'b1;
      d_q <= 1'b0;
    end
  end

  // Behind the proof: what was inside a clock ago, which the lines show.

  logic sending;
  logic [1:0] quarter;
  logic [CountWidth-1:0] symbol, stop, number;
  logic [1:0] elapsed;  // clocks of the quarter
  logic late;           // a pulse that began in this symbol is counted
  always_ff @(posedge clk) begin
    sending <= dut.sending;
    quarter <= dut.quarter;
    symbol <= dut.symbol;
    stop <= dut.stop_symbol;
    elapsed <= 2'(QuarterClocks - 1) - dut.clocks;
  end
  assign number = dut.symbol == '0 ? '0 : dut.symbol - CountWidth'(1);
  assign late = quarter > 2'd1 || (quarter == 2'd1 && elapsed != '0);
  always_comb begin
    if (started) begin
      sends: assert (dut.sending == (dut.state == Send));
      if (dut.state != Fetch) its_kind: assert (dut.kind == (32'(entry) >= 3 ? 2'd0 : 2'd3 - 2'(entry)));
      if (dut.sending) its_step: assert (dut.step != 2'd3 && dut.kind != Pins
          && (dut.step == Write ? !dut.kind[1] : dut.kind != 2'd1));
      if (dut.sending) lengths: assert (32'(bits) == 18 + 9 * AddressBytes || 32'(bits) == 9 + 9 * AddressBytes
          || bits == CountWidth'(18));
      if (dut.sending) length: assert (dut.stop_symbol == bits + CountWidth'(1) && dut.symbol <= dut.stop_symbol);
      if (dut.sending) still_to_send: assert (dut.bits == ~(~frame << number));
      if (!fresh_q && sending) begin
        symbol_in_range: assert (symbol <= stop && stop == bits + CountWidth'(1));
        if (symbol != '0) counted: assert (busy == (symbol != stop || !late || (quarter == 2'd2 && elapsed == '0)
            || quarter == 2'd1) && pulses == symbol - CountWidth'(!late));
        if (symbol == '0) not_yet: assert (busy == late && (!late || pulses == '0));
        c_age: assert (32'(c_since) == (elapsed != '0 && (symbol == '0 ? quarter == 2'd2 : symbol == stop
            ? quarter == 2'd1 : quarter[0]) ? 32'(elapsed) : QuarterClocks));
        d_age: assert (32'(d_since) == QuarterClocks || (elapsed != '0 && d_since == 3'(elapsed)
            && quarter == (symbol == '0 ? 2'd1 : symbol == stop && quarter[1] ? 2'd2 : 2'd0)));
      end
      if (!fresh_q && !sending) at_rest: assert (!busy && 32'(c_since) == QuarterClocks
          && 32'(d_since) == QuarterClocks && sio_c && !sio_d_low && c_q && !d_q);
    end
  end

  logic rises, falls, moves;
  assign rises = ~c_q & sio_c;
  assign falls = c_q & ~sio_c;
  assign moves = d_q != sio_d_low;
  always_comb begin
    if (started && !fresh_q) begin
      if (moves && c_q && sio_c) start_or_stop: assert (sio_d_low ? !busy : busy && pulses == bits + CountWidth'(1));
      if (rises && pulses < bits) its_bit: assert (busy && sio_d_low == !expected);
      if (rises && pulses == bits) before_stop: assert (busy && sio_d_low);
      if (rises) no_more: assert (pulses <= bits);
      if (rises || falls) clock_lasts: assert (32'(c_since) == QuarterClocks && !moves);
      if (rises) data_before: assert (32'(d_since) == QuarterClocks);
      if (moves) data_after: assert (32'(c_since) == QuarterClocks || !sio_c && !c_q);
      if (!busy && !moves) idle: assert (sio_c && !sio_d_low);
      stops: cover (moves && !sio_d_low && sio_c && pulses > CountWidth'(9));
    end
  end
end
