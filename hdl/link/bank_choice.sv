// SPDX-License-Identifier: Apache-2.0
// bank_choice: choice of two banks for the writer and the reader, and of the frame that waits for the reader.
//
// A frame begins (write_begin), is whole (write_end), and becomes ready (publish: with write_end, or later, also inside
// the next frame). Then it waits until the reader takes it (take, only while `waiting` and keep), and is read up to
// `done`. The pulses of the writer: write_end only inside a frame, not with write_begin. Those of the reader: done only
// while `reading`; take not while `reading`, but with done.
//
// A frame begins in a bank that is not being read: in the one without a whole frame, or with the older of two. What
// stood there is lost. A write_begin inside a frame begins it again, in the same bank. A frame that becomes ready
// replaces the one that waits. `replaced` is high for one clock for each frame that is lost so. While keep is low no
// frame becomes ready, the one that waits is given up, and nothing counts as replaced. A bank is free for the writer in
// the clock of done.
// Cycle-accurate model: models/tactile_depth/chip/link/bank_choice.py.

`default_nettype none

module bank_choice (
  input  wire  clk,
  input  wire  rst,
  input  wire  keep,
  input  wire  write_begin,
  input  wire  write_end,
  input  wire  publish,
  output logic write_bank,  // from the clock of write_begin to that of write_end
  output logic waiting,
  input  wire  take,
  input  wire  done,
  output logic reading,     // from the clock after take to that of done
  output logic read_bank,   // while reading
  output logic replaced
);

  // Bank n is bit n; at most one bit of each is high, and no bank is in two of them.
  logic [1:0] written;  // a frame is being written
  logic [1:0] whole;    // it holds a whole frame that is not ready
  logic [1:0] ready;    // its frame waits
  logic [1:0] read;     // its frame is being read

  logic [1:0] taken, busy, held, chosen, begun, ended, published, whole_next, ready_next;
  assign taken = take ? ready : 2'b00;
  assign busy = taken | (done ? 2'b00 : read);
  assign held = whole | (ready & ~taken);
  always_comb begin
    if (written != 2'b00) chosen = written;
    else if (busy != 2'b00) chosen = ~busy;
    else if (held == 2'b11) chosen = ready;  // the older one
    else chosen = held == 2'b01 ? 2'b10 : 2'b01;
  end
  assign begun = write_begin ? chosen : 2'b00;
  assign ended = write_end ? written : 2'b00;
  assign published = ~publish ? 2'b00 : write_end ? written : whole;
  assign whole_next = (publish ? 2'b00 : write_end ? written : whole) & ~begun;
  assign ready_next = ~keep ? 2'b00 : (published != 2'b00 ? published : ready & ~taken) & ~begun;

  assign write_bank = write_begin ? chosen[1] : written[1];
  assign waiting = ready != 2'b00;
  assign reading = read != 2'b00;
  assign read_bank = read[1];
  assign replaced = keep & (held & ~(whole_next | ready_next)) != 2'b00;

  always_ff @(posedge clk) begin
    written <= (written & ~ended) | begun;
    whole <= whole_next;
    ready <= ready_next;
    read <= busy;
    if (rst) begin
      written <= '0;
      whole <= '0;
      ready <= '0;
      read <= '0;
    end
  end

endmodule

`default_nettype wire
