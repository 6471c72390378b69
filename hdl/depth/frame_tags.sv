// SPDX-License-Identifier: Apache-2.0
// frame_tags: keeps a tag for each frame that is in the solver, until its first depth is due, and a part of it longer.
//
// A tag is pushed with the last pixel of a frame. Latency enabled cycles later `due` is high for one enabled cycle,
// with the tag on due_tag. No order is kept: each slot compares the time with its own, so an upset costs the frame it
// hits and no other. Pushes lie at least Pixels enabled cycles apart, so there are never more tags than slots.
// `late` adds a part to the tag that was pushed last, before that is due. Up to Keep enabled cycles after a tag was due
// late_tag has its part, and late_marked whether `mark` was high, enabled or not, since the push, or `marked` with it.
// Cycle-accurate model: models/tactile_depth/chip/depth/frame_tags.py.

`default_nettype none

module frame_tags
  import td_config_pkg::*;
#(
  parameter int Width     = 34,
  parameter int LateWidth = 96,
  parameter int Latency   = value(DefaultConfig, FrameLatencyField),  // from last pixel to first depth, > 1
  parameter int Keep      = 1,
  parameter int Pixels    = value(DefaultConfig, RowsField) * value(DefaultConfig, ColumnsField)
) (
  input  wire                  clk,
  input  wire                  rst,
  input  wire                  en,
  input  wire                  push,
  input  wire  [Width-1:0]     tag,
  input  wire                  marked,
  input  wire                  late,
  input  wire  [LateWidth-1:0] late_part,
  input  wire                  mark,
  output logic                 due,
  output logic [Width-1:0]     due_tag,
  output logic [LateWidth-1:0] late_tag,
  output logic                 late_marked,
  output logic                 held          // there are tags
);

  localparam int Slots = (Latency + Keep + Pixels - 1) / Pixels;
  localparam int SlotWidth = Slots > 1 ? $clog2(Slots) : 1;
  localparam int ClockWidth = $clog2(Latency + 1);

  logic [ClockWidth-1:0] now, due_clock[Slots];  // due_clock: the enabled cycle before a tag is due
  logic [Width-1:0] tags[Slots];
  logic [LateWidth-1:0] lates[Slots];
  logic [Slots-1:0] full, due_here, last_here, marks;  // last_here: its tag was due last
  logic [SlotWidth-1:0] write_slot, late_slot;

  always_comb begin
    {due_tag, late_tag} = '0;
    for (int i = 0; i < Slots; i++) begin
      if (due_here[i] || Slots == 1) due_tag = due_tag | tags[i];
      if (last_here[i] || Slots == 1) late_tag = late_tag | lates[i];
    end
  end
  assign late_marked = |(marks & (last_here | {Slots{Slots == 1}}));
  assign due = |due_here;
  assign held = |full;

  always_ff @(posedge clk) begin
    if (mark) marks <= '1;
    if (en) begin
      now <= now + ClockWidth'(1);
      full <= full & ~due_here;
      for (int i = 0; i < Slots; i++) begin
        due_here[i] <= full[i] & (due_clock[i] == now);
        if (push && write_slot == SlotWidth'(i)) marks[i] <= marked | mark;
      end
      if (due) last_here <= due_here;
      if (late) lates[late_slot] <= late_part;
      if (push) begin
        tags[write_slot] <= tag;
        late_slot <= write_slot;
        due_clock[write_slot] <= now + ClockWidth'(Latency - 1);
        full[write_slot] <= 1'b1;
        write_slot <= write_slot == SlotWidth'(Slots - 1) ? '0 : write_slot + SlotWidth'(1);
      end
    end
    if (rst) begin
      now <= '0;
      {full, due_here} <= '0;
      write_slot <= '0;
    end
  end

endmodule

`default_nettype wire
