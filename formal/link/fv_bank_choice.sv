// SPDX-License-Identifier: Apache-2.0
// fv_bank_choice: the bank that is read, or taken, is never written. A frame begins in a bank without a whole frame, if
// one is free, or with the older of two; one that begins again stays in its bank. The frame that is taken is whole, and
// the newest that became ready; it stays while it is read. Each frame that ended waits, is taken, or is lost; each loss
// is counted once. Without a reader none is overwritten before it is ready.
//
// Frames are numbered modulo 8; the bench follows what stands in each bank.

wire in_frame = u_protocol.begun;

// Frames that are held: `ended` is whole and awaits publish, `ready` waits for the reader.
logic [2:0] number, ended_number, ready_number, taken_number;
logic [1:0][2:0] content;
logic [1:0] whole;  // the bank's frame is whole
logic ended, ended_bank, ready, ready_bank, last_bank;
logic overwrites_ended, overwrites_ready, publishes, ended_next, ready_next;
assign overwrites_ended = write_begin & ended & write_bank == ended_bank;
assign overwrites_ready = write_begin & ready & ~take & write_bank == ready_bank;
assign publishes = publish & keep & (write_end | (ended & ~overwrites_ended));
assign ended_next = ~publish & (write_end | (ended & ~overwrites_ended));
assign ready_next = keep & (publishes | (ready & ~take & ~overwrites_ready));
logic [1:0] lost;
assign lost = 2'(ended) + 2'(ready) + 2'(write_end) - 2'(take) - 2'(ended_next) - 2'(ready_next);

always_ff @(posedge clk) begin
  if (write_begin) begin
    number <= number + 3'd1;
    content[write_bank] <= number + 3'd1;
    whole[write_bank] <= 1'b0;
    last_bank <= write_bank;
  end
  if (write_end) begin
    whole[write_bank] <= 1'b1;
    ended_number <= number;
    ended_bank <= write_bank;
  end
  if (publishes) begin
    ready_number <= write_end ? number : ended_number;
    ready_bank <= write_end ? write_bank : ended_bank;
  end
  if (take) taken_number <= ready_number;
  ended <= ended_next;
  ready <= ready_next;
  if (rst) begin
    ended <= 1'b0;
    ready <= 1'b0;
  end
end

logic writes, other;
assign writes = write_begin | in_frame;
assign other = ~write_bank;
logic [1:0] holds_frame, is_read;  // from this clock on
for (genvar bank = 0; bank < 2; bank++) begin : g_bank
  assign holds_frame[bank] = (ended & ended_bank == 1'(bank)) | (ready & ~take & ready_bank == 1'(bank));
  assign is_read[bank] = (reading & ~done & read_bank == 1'(bank)) | (take & ready_bank == 1'(bank));
end

always_comb begin
  if (started && !rst) begin
    waits: assert (waiting == ready);
    if (writes) apart: assert (!is_read[write_bank]);
    if (write_begin && in_frame) again: assert (write_bank == last_bank);
    if (in_frame && !write_begin) kept: assert (write_bank == last_bank);
    if (write_begin && !in_frame) begin
      free_first: assert (!holds_frame[write_bank] || holds_frame[other] || is_read[other]);
      if (holds_frame == 2'b11) older: assert (ready && write_bank == ready_bank);
    end
    if (reading) newest_whole: assert (whole[read_bank] && content[read_bank] == taken_number);
    counted: assert (replaced == (keep && lost != 2'd0));
    if (keep) one_at_a_time: assert (lost <= 2'd1);
    if (overwrites_ended) with_a_reader: assert (reading || take);
    // Behind the proof.
    if (ended) ended_there: assert (whole[ended_bank] && content[ended_bank] == ended_number);
    if (ready) ready_there: assert (whole[ready_bank] && content[ready_bank] == ready_number);
    if (ended && ready) banks_apart: assert (ended_bank != ready_bank);
    loses_ended: cover (overwrites_ended && keep && !publish);
    loses_older: cover (overwrites_ready && ended);
    late: cover (publishes && in_frame && ready && !take);
    next_at_once: cover (take && done);
    gives_up: cover (!keep && ready);
  end
end

// Protocol: a frame ends once, behind its begin; take while a frame waits and the reader is free, done while one is
// read. A bank counts while it is written, or read.
module protocol_bank_choice;
  logic begun = 1'b0;
  assign holds = rst | ((~write_end | (begun & ~write_begin)) & (~done | reading)
      & (~take | (waiting & keep & (~reading | done))));
  assign counts = live & ~reset;
  assign counts_write_bank = counts & (write_begin | begun);
  assign counts_read_bank = counts & reading;
  always_ff @(posedge clk) begin
    if (write_begin || write_end) begun <= write_begin;
    if (reset) begun <= 1'b0;
  end
endmodule
