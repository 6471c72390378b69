// SPDX-License-Identifier: Apache-2.0
// fv_depth_store: the frame that waits is whole, with its own record, and the newest that came so; nothing else waits.
// From take to done each value and word is that frame's, in time. `skipped` counts each whole frame that is lost.
// ram_check watches both memories.
//
// One bit of an arbitrary value and of an arbitrary word of the record is followed.

parameter int Rows = 2;
parameter int Columns = 2;
parameter int DataWidth = 2;
parameter int Lanes = 1;
input logic [PlaceWidth-1:0] pick;
input logic [3:0] pick_word;

localparam int Pixels = Rows * Columns;

bind dut.g_bank[0].u_values ram_check #(.Depth(Depth), .Covered(0)) u_check (.*);
bind dut.g_bank[1].u_values ram_check #(.Depth(Depth), .Covered(0)) u_check (.*);
bind dut.u_records ram_check #(.Depth(Depth), .Covered(0)) u_check (.*);

logic written, begins, ends, awaited, reading;
logic [PlaceWidth:0] beat;
logic [3:0] word;
protocol_depth_store #(.Rows(Rows), .Columns(Columns), .Lanes(Lanes)) u_protocol (
  .clk, .rst, .keep, .s_axis_tvalid, .s_axis_tuser, .s_event_tvalid, .s_event_tlast, .frame_valid, .frame_take,
  .frame_done, .value_read, .value_address, .record_word, .written, .beat, .begins, .ends, .awaited, .word, .reading,
  .holds(allowed)
);
always_comb assume (32'(pick) < Pixels && pick_word <= 4'd11);

// The followed bit of the value, and of the word, of each frame: it comes, has ended, waits, is taken.
logic [PlaceWidth-1:0] place;
logic [3:0] place_word;
logic came, came_next, came_word, came_word_next, ended_value, ready_value, ready_word, taken_value, taken_word;
logic in_frame, ended, ready, busy, record_ends, loses_ended, loses_ready, ended_next, ready_next;
logic read_q, read_q2, word_read_q, was_reset;
assign busy = frame_take | (reading & ~frame_done);
assign record_ends = s_event_tvalid & s_event_tlast & awaited;
assign loses_ended = begins & ~in_frame & ended & busy;
assign loses_ready = begins & ~in_frame & ready & ~frame_take & (busy | ended);
assign ended_next = ends | (ended & ~record_ends & ~loses_ended);
assign ready_next = keep & ((record_ends & ended & ~loses_ended) | (ready & ~frame_take & ~loses_ready));
assign came_next = written && beat == (PlaceWidth + 1)'(32'(place) / Lanes)
    ? s_axis_tdata[32'(place) % Lanes * LaneBits] : came;
assign came_word_next = s_event_tvalid && word == place_word ? s_event_tdata[0] : came_word;

always_ff @(posedge clk) begin
  was_reset <= rst;
  if (!started) {place, place_word} <= {pick, pick_word};
  {came, came_word} <= {came_next, came_word_next};
  if (begins || ends) in_frame <= begins;
  if (ends) ended_value <= came_next;
  if (record_ends && ended) {ready_value, ready_word} <= {ended_value, came_word_next};
  if (frame_take) {taken_value, taken_word} <= {ready_value, ready_word};
  ended <= ended_next;
  ready <= ready_next;
  read_q <= value_read & value_address == place;
  read_q2 <= read_q;
  word_read_q <= reading & record_word == place_word;
  if (rst) begin
    {in_frame, ended, ready} <= '0;
    {read_q, read_q2, word_read_q} <= '0;
  end
end

logic [1:0] lost;
assign lost = 2'(ended) + 2'(ready) + 2'(ends) - 2'(frame_take) - 2'(ended_next) - 2'(ready_next);
always_comb begin
  if (started && !rst) begin
    waits: assert (frame_valid == ready);
    counted: assert (skipped == (keep && lost != 2'd0));
    if (read_q2 && !was_reset) value_of_frame: assert (value_data[0] == taken_value);
    if (word_read_q) word_of_frame: assert (record_data[0] == taken_word);
    loses_one: cover (skipped && loses_ready && !busy);
    reads: cover (read_q2 && word_read_q);
  end
end
