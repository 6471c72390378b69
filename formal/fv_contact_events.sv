// SPDX-License-Identifier: Apache-2.0
// fv_contact_events: a record Latency clocks after the last depth of each frame and at no other time; touching by its
// rule, from the count of depths above the threshold in force; zeros where nothing was above; an arbitrary depth above
// lies within the limits and is no higher than the peak, and the peak is a depth of its place; packets are whole, in
// order, each the record that stood when it began; stable under stall; a record is sent, lost and said so, or waits.
//
// Whatever frames come, one may begin inside another; their last depths lie at least Latency clocks apart, as the core
// asks. So the frames here may be smaller than those that need no gaps for that. The sums and the division are left to
// simulation.

module fv_contact_events #(
  parameter int Width       = 2,
  parameter int Rows        = 3,
  parameter int Columns     = 4,
  parameter int BottomFirst = 0,
  parameter int Latency     = 20,  // models/contact_events.py
  parameter int Part        = 0    // one of Timing, Rule, Limits
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

  localparam int Timing = 0;
  localparam int Rule = 1;
  localparam int Limits = 2;
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

  // They stand still: that they are taken with the first depth of a frame is left to simulation.
  logic [2*(Width+1)+6:0] settings, settings_q;
  assign settings = {on_setting, off_setting, minimum_setting, debounce_setting};
  always_ff @(posedge clk) settings_q <= settings;
  always_comb if (started) assume (settings == settings_q);

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

  logic signed [33:0] excess_on, excess_off;
  assign excess_on = 34'(in_data) - 34'(on_threshold);
  assign excess_off = 34'(in_data) - 34'(off_threshold);

  logic beat, first, whole, over_on, over_off, over, decide, state, state_now, state_q, turn;
  logic [CountWidth-1:0] count;
  logic [7:0] contrary;  // frames in a row that differ from the state
  assign turn = decide & ((32'(count) >= minimum_area) != state) & (32'(contrary) + 32'd1 >= 32'(debounce));
  assign state_now = state ^ turn;
  assign over = state_now ? over_off : over_on;

  // An arbitrary depth of a frame.

  logic picked, here;  // one is followed in this frame; it was, in the clock before
  logic signed [Width-1:0] value;
  logic [15:0] value_row, value_column;
  logic counts, any;  // it is above; some are
  logic whole_counts, whole_picked, whole_any;
  logic [CountWidth-1:0] whole_count;
  logic signed [Width-1:0] whole_value;
  logic [15:0] whole_row, whole_column;

  // A record: when it is due, and what it was when a packet of it began.

  logic [Latency-1:0] due;
  logic [32*Words-1:0] record_q;
  logic [3:0] watched, word;
  logic first_bit, sent_bit;  // of the word watched: words are all sent alike
  logic waits, offered, stalled, stalled_last, rst_q, packet_ends;
  assign packet_ends = m_event_tvalid & m_event_tready & m_event_tlast;
  logic [31:0] stalled_data;
  assign first_bit = 1'(record_q >> {watched, 5'd0});

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
    if (decide) contrary <= turn || (32'(count) >= minimum_area) == state ? 8'd0 : contrary + 8'd1;
    if (beat && whole) begin
      whole_picked <= picked;
      whole_value <= value;
      whole_row <= value_row;
      whole_column <= value_column;
    end
    if (decide) begin
      whole_counts <= counts;
      whole_any <= any;
      whole_count <= count;
    end
    due <= Latency'({due, in_valid & in_frame_end});
    record_q <= record;
    waits <= due[Latency-2] | (waits & m_event_tvalid & ~packet_ends);
    offered <= m_event_tvalid & ~packet_ends;
    stalled <= m_event_tvalid & ~m_event_tready;
    stalled_data <= m_event_tdata;
    stalled_last <= m_event_tlast;
    if (m_event_tvalid && !offered) sent_bit <= first_bit;
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
  always_comb begin
    assume (pick_word < 4'(Words));
    if (due[Latency-2:0] != '0) assume (!(in_valid && in_frame_end));
  end

  logic signed [31:0] peak;
  logic [31:0] peak_place, least, greatest, area;
  assign area = record[32*3+:32];
  assign peak = record[32*4+:32];
  assign peak_place = record[32*5+:32];
  assign least = record[32*6+:32];
  assign greatest = record[32*7+:32];

  if (Part == Timing) begin : g_timing
    always_comb begin
      if (started) begin
        record_due: assert (record_valid == due[Latency-1]);
        if (!record_valid && !rst_q) keeps: assert (record == record_q);
        if (rst_q) quiet: assert (!m_event_tvalid && record == '0);
        if (stalled) stable: assert (m_event_tvalid && m_event_tdata == stalled_data && m_event_tlast == stalled_last);
        if (offered) whole_packet: assert (m_event_tvalid);
        if (m_event_tvalid) begin
          last_of_packet: assert (m_event_tlast == (word == 4'(Words - 1)));
          if (word == watched) as_it_was: assert (m_event_tdata[0] == (offered ? sent_bit : first_bit));
        end
        lost_and_said: assert (event_lost == (due[Latency-2] & waits & m_event_tvalid & ~packet_ends));
        sent_if_free: assert (m_event_tvalid || !waits || due[Latency-1]);
        slow: cover (event_lost && word == 4'd1);
        next_follows: cover (waits && packet_ends);
      end
    end
  end

  if (Part == Rule) begin : g_rule
    always_comb begin
      if (started) begin
        by_the_rule: assert (touching == state);
        if (record_valid) begin
          status: assert (record[0] == state && !(record[1] && record[2]) && record[31:3] == '0);
          counted: assert (area == 32'(whole_count));
          if (!whole_any) zeros: assert (record[32*Words-1:32*3] == '0);
          begins: cover (record[1] && area == 32'd2);
          ends: cover (record[2]);
        end
      end
    end
  end

  if (Part == Limits) begin : g_limits
    always_comb begin
      if (started && record_valid && whole_picked && whole_counts) begin
        no_higher: assert (32'(whole_value) <= peak);
        rows_limited: assert (least[31:16] <= whole_row && whole_row <= greatest[31:16]);
        columns_limited: assert (least[15:0] <= whole_column && whole_column <= greatest[15:0]);
        if (peak_place == {whole_row, whole_column}) its_own: assert (32'(whole_value) == peak);
        not_at_the_rim: cover (least[15:0] < whole_column && whole_column < greatest[15:0] && 32'(whole_value) < peak);
      end
    end
  end

endmodule
