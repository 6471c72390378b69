// SPDX-License-Identifier: Apache-2.0
// fv_depth_store: the frame that waits is whole, with its own record, and the newest that came so; nothing else waits.
// From take to done each value and word is that frame's, in time. `skipped` counts each whole frame that is lost.
// ram_check watches both memories.
//
// One bit of an arbitrary value and of an arbitrary word of the record is followed.

parameter int Rows = 2, Columns = 2, DataWidth = 2, Lanes = 1;
input logic [PlaceWidth-1:0] pick;
input logic [3:0] pick_word;

localparam int Pixels = Rows * Columns;

bind dut.g_bank[0].u_values ram_check #(.Depth(Depth), .Covered(0)) u_check (.*);
bind dut.g_bank[1].u_values ram_check #(.Depth(Depth), .Covered(0)) u_check (.*);
bind dut.u_records ram_check #(.Depth(Depth), .Covered(0)) u_check (.*);

wire written = u_protocol.written, begins = u_protocol.begins,
    ends = u_protocol.ends, awaited = u_protocol.waits, reading = u_protocol.taken;
wire [PlaceWidth:0] beat = u_protocol.beat;
wire [3:0] word = u_protocol.next_word;
always_comb assume (32'(pick) < Pixels && pick_word <= 4'd14);

// The followed bit of the value, and of the word, of each frame: it comes, has ended, waits, is taken.
logic [PlaceWidth-1:0] place;
logic [3:0] place_word;
logic came, came_next, came_word, came_word_next, ended_value, ready_value, ready_word, taken_value, taken_value_q, taken_word;
logic in_frame, ended, ready, busy, record_ends, loses_ended, loses_ready, ended_next, ready_next;
logic read_q, read_q2, read_q3, word_read_q, was_reset;
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
  {read_q2, read_q3} <= {read_q, read_q2};
  taken_value_q <= taken_value;
  word_read_q <= reading & record_word == place_word;
  if (rst) begin
    {in_frame, ended, ready} <= '0;
    {read_q, read_q2, read_q3, word_read_q} <= '0;
  end
end

logic [1:0] lost;
assign lost = 2'(ended) + 2'(ready) + 2'(ends) - 2'(frame_take) - 2'(ended_next) - 2'(ready_next);
always_comb begin
  if (started && !rst) begin
    waits: assert (frame_valid == ready);
    counted: assert (skipped == (keep && lost != 2'd0));
    if (read_q3 && !was_reset) value_of_frame: assert (value_data[0] == taken_value_q);
    if (word_read_q) word_of_frame: assert (record_data[0] == taken_word);
    loses_one: cover (skipped && loses_ready && !busy);
    reads: cover (read_q3 && word_read_q);
  end
end

// Protocol: any beats; a record of 15 words behind the last beat of its frame and before the last beat of the next,
// or without a frame, between last beats too. The reader takes a frame that waits, and reads inside it; what it
// reads counts.
module protocol_depth_store;
  localparam int Pixels = Rows * Columns;
  logic written;  // a beat belongs to a frame
  logic [PlaceWidth:0] beat;  // its place
  logic begins, ends;
  localparam int Beats = Pixels / Lanes;
  logic in_frame = 1'b0, waits = 1'b0, taken = 1'b0, was_taken = 1'b0, known = 1'b0;
  logic [1:0] known_q = '0;
  logic [PlaceWidth:0] next_beat = '0;
  logic [3:0] next_word = '0;
  assign begins = s_axis_tvalid & s_axis_tuser;
  assign written = s_axis_tvalid & (s_axis_tuser | in_frame);
  assign beat = s_axis_tuser ? '0 : next_beat;
  assign ends = written & beat == (PlaceWidth + 1)'(Beats - 1);
  assign holds = (rst | ((~ends | (~waits & next_word == '0 & ~s_event_tvalid))
      & (~s_event_tvalid | s_event_tlast == (next_word == 4'd14))))
      & (~frame_take | (frame_valid & keep & ~taken)) & (~frame_done | taken) & (~value_read | (taken & ~frame_done & 32'(value_address) < Pixels))
      & record_word <= 4'd14;
  assign counts = live & ~reset;
  assign counts_value_data = counts & known_q[1];
  assign counts_record_data = counts & was_taken;
  always_ff @(posedge clk) begin
    if (s_axis_tvalid) next_beat <= beat + (PlaceWidth + 1)'(1);
    if (begins || ends) in_frame <= begins;
    if (s_event_tvalid) next_word <= s_event_tlast ? '0 : next_word + 4'd1;
    waits <= ends | (waits & ~(s_event_tvalid & s_event_tlast));
    taken <= frame_take | (taken & ~frame_done);
    was_taken <= taken;
    known <= known | (value_read & holds);
    known_q <= {known_q[0], known};
    if (reset) begin
      in_frame <= 1'b0;
      next_word <= '0;
      waits <= 1'b0;
      taken <= 1'b0;
      was_taken <= 1'b0;
    end
  end
endmodule
