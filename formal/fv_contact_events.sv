// SPDX-License-Identifier: Apache-2.0
// fv_contact_events: a record Latency clocks after the last depth of each frame and at no other time; touching by its
// rule, from the count of depths above the threshold in force; zeros where nothing was above; an arbitrary depth above
// lies within the limits and is no higher than the peak, and the peak is a depth of its place; packets are whole, in
// order, each the record that stood when it began; stable under stall; a record is sent, lost and said so, or waits.
//
// Whatever frames come, one may begin inside another. The sums and the division are left to simulation.

module fv_contact_events #(
  parameter int Width       = 2,
  parameter int Rows        = 3,
  parameter int Columns     = 8,
  parameter int BottomFirst = 0,
  parameter int Latency     = 22  // models/contact_events.py
) (
  input logic                    clk,
  input logic                    rst,
  input logic                    in_valid,
  input logic                    restart,
  input logic signed [Width-1:0] in_data,
  input logic signed [Width:0]   on_setting,
  input logic signed [Width:0]   off_setting,
  input logic [4:0]              minimum_setting,
  input logic [1:0]              debounce_setting,
  input logic                    m_event_tready,
  input logic                    pick,
  input logic [3:0]              pick_word
);

  localparam int Words = 13;
  localparam int Pixels = Rows * Columns;
  localparam int CountWidth = $clog2(Pixels + 1);

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  // Settings are only compared: as far as they matter here.
  logic signed [31:0] on_threshold, off_threshold;
  logic [31:0] minimum_area;
  logic [7:0] debounce;
  assign on_threshold = 32'(on_setting);
  assign off_threshold = 32'(off_setting);
  assign minimum_area = 32'(minimum_setting);
  assign debounce = 8'(debounce_setting);

  logic in_user, in_last, in_frame_end, touching, record_valid, event_lost, m_event_tvalid, m_event_tlast;
  logic [32*Words-1:0] record;
  logic [31:0] m_event_tdata;
  contact_events #(.Width(Width), .Rows(Rows), .Columns(Columns), .BottomFirst(BottomFirst)) dut (
    .clk, .rst, .in_valid, .in_user, .in_last, .in_frame_end, .in_data, .in_time(32'd0), .on_threshold, .off_threshold,
    .minimum_area, .debounce, .touching, .record_valid, .record, .event_lost, .m_event_tdata, .m_event_tvalid,
    .m_event_tready, .m_event_tlast
  );

  // Frames, and where in the picture a depth lies.

  logic [CountWidth-1:0] next_place, place;
  logic [15:0] row, column;
  assign in_user = restart | (next_place == '0);
  assign place = in_user ? '0 : next_place;
  assign column = 16'(place % CountWidth'(Columns));
  assign row = BottomFirst != 0 ? 16'(Rows - 1) - 16'(place / CountWidth'(Columns)) : 16'(place / CountWidth'(Columns));
  assign in_last = column == 16'(Columns - 1);
  assign in_frame_end = place == CountWidth'(Pixels - 1);

  // The event, from counts of its own: a clock after the depths, so that a frame's first meets what the last decided.

  logic signed [31:0] on_q, off_q, on_now, off_now;
  logic signed [33:0] excess_on, excess_off;
  assign on_now = in_user ? on_threshold : on_q;
  assign off_now = in_user ? off_threshold : off_q;
  assign excess_on = 34'(in_data) - 34'(on_now);
  assign excess_off = 34'(in_data) - 34'(off_now);

  logic beat, first, whole, over_on, over_off, over, decide, state, state_now, state_q, turn;
  logic [CountWidth-1:0] count;
  logic [31:0] minimum, minimum_of_whole;
  logic [7:0] needed, needed_of_whole, contrary;  // frames in a row that differ from the state
  assign turn = decide & ((32'(count) >= minimum_of_whole) != state) & (32'(contrary) + 32'd1 >= 32'(needed_of_whole));
  assign state_now = state ^ turn;
  assign over = state_now ? over_off : over_on;

  // An arbitrary depth of a frame.

  logic picked, here;  // one is followed in this frame; it was, in the clock before
  logic signed [Width-1:0] value;
  logic [15:0] value_row, value_column;
  logic counts, any;  // it is above; some are
  logic whole_q, whole_counts, whole_picked, whole_any;
  logic signed [Width-1:0] whole_value;
  logic [15:0] whole_row, whole_column;

  // A record: when it is due, and what it was when a packet of it began.

  logic [Latency-1:0] due;
  logic [32*Words-1:0] record_q;
  logic [3:0] watched, word;
  logic [31:0] word_q, sent_word;
  logic waits, offered, stalled, stalled_last, rst_q;
  logic [31:0] stalled_data;
  assign word_q = 32'(record_q >> {watched, 5'd0});

  always_ff @(posedge clk) begin
    started <= 1'b1;
    rst_q <= rst;
    beat <= in_valid;
    first <= in_user;
    whole <= in_frame_end;
    over_on <= excess_on > 0;
    over_off <= excess_off > 0;
    if (in_valid) begin
      next_place <= in_frame_end ? '0 : place + CountWidth'(1);
      on_q <= on_now;
      off_q <= off_now;
      if (in_user) begin
        minimum <= minimum_area;
        needed <= debounce;
      end
      if (in_frame_end) begin
        minimum_of_whole <= minimum;
        needed_of_whole <= needed;
      end
      here <= pick & ~(picked & ~in_user);
      picked <= pick | (picked & ~in_user);
      if (pick && !(picked && !in_user)) begin
        value <= in_data;
        value_row <= row;
        value_column <= column;
      end
    end
    decide <= beat & whole;
    state <= state_now;
    state_q <= state;
    if (beat) begin
      count <= (first ? '0 : count) + CountWidth'(over);
      any <= over | (any & ~first);
      counts <= here ? over : counts;
    end
    if (decide) contrary <= turn || (32'(count) >= minimum_of_whole) == state ? 8'd0 : contrary + 8'd1;
    if (beat && whole) begin
      whole_picked <= picked;
      whole_value <= value;
      whole_row <= value_row;
      whole_column <= value_column;
    end
    if (decide) begin
      whole_counts <= counts;
      whole_any <= any;
    end
    due <= Latency'({due, in_valid & in_frame_end});
    record_q <= record;
    waits <= due[Latency-2] | (waits & m_event_tvalid & ~(m_event_tready & m_event_tlast));
    offered <= m_event_tvalid & ~(m_event_tready & m_event_tlast);
    stalled <= m_event_tvalid & ~m_event_tready;
    stalled_data <= m_event_tdata;
    stalled_last <= m_event_tlast;
    if (m_event_tvalid && !offered) sent_word <= word_q;
    if (m_event_tvalid && m_event_tready) word <= m_event_tlast ? 4'd0 : word + 4'd1;
    if (!m_event_tvalid) watched <= pick_word;
    if (rst) begin
      next_place <= '0;
      beat <= 1'b0;
      decide <= 1'b0;
      state <= 1'b0;
      state_q <= 1'b0;
      contrary <= '0;
      due <= '0;
      waits <= 1'b0;
      offered <= 1'b0;
      stalled <= 1'b0;
      word <= '0;
    end
  end
  always_comb assume (pick_word < 4'(Words));

  logic signed [31:0] peak;
  logic [31:0] peak_place, least, greatest, area;
  assign area = record[32*3+:32];
  assign peak = record[32*4+:32];
  assign peak_place = record[32*5+:32];
  assign least = record[32*6+:32];
  assign greatest = record[32*7+:32];
  always_comb begin
    if (started) begin
      by_the_rule: assert (touching == state);
      record_due: assert (record_valid == due[Latency-1]);
      if (!record_valid && !rst_q) keeps: assert (record == record_q);
      if (record_valid) begin
        status: assert (record[0] == state && !(record[1] && record[2]) && record[31:3] == '0);
        some_or_none: assert ((area != '0) == whole_any);
        if (!whole_any) zeros: assert (record[32*Words-1:32*4] == '0);
        if (whole_picked && whole_counts) begin
          no_higher: assert (32'(whole_value) <= peak);
          rows_limited: assert (least[31:16] <= whole_row && whole_row <= greatest[31:16]);
          columns_limited: assert (least[15:0] <= whole_column && whole_column <= greatest[15:0]);
          if (peak_place == {whole_row, whole_column}) its_own: assert (32'(whole_value) == peak);
        end
        contact: cover (touching && whole_counts && peak == 32'sd1 && area == 32'd2);
        ends: cover (record[2]);
        empty: cover (area == '0);
      end
      if (rst_q) quiet: assert (!m_event_tvalid && record == '0);
      if (stalled) stable: assert (m_event_tvalid && m_event_tdata == stalled_data && m_event_tlast == stalled_last);
      if (offered) whole_packet: assert (m_event_tvalid);
      if (m_event_tvalid) begin
        last_of_packet: assert (m_event_tlast == (word == 4'(Words - 1)));
        if (word == watched) as_it_was: assert (m_event_tdata == (offered ? sent_word : word_q));
        slow: cover (event_lost && word == 4'd7);
        next_follows: cover (waits && m_event_tready && m_event_tlast);
      end
      lost_and_said: assert (event_lost == (due[Latency-2] & waits & m_event_tvalid & ~(m_event_tready & m_event_tlast)));
    end
  end

endmodule
