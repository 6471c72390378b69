// SPDX-License-Identifier: Apache-2.0
// frame_tags: keeps a tag for each frame that is in the solver, until its first depth is due.
//
// A tag is pushed with the last pixel of a frame. Latency enabled cycles later `due` is high for one enabled cycle,
// with the tag on due_tag. No order is kept: each slot compares the time with its own, so an upset costs the frame it
// hits and no other. Pushes lie at least Pixels enabled cycles apart, so there are never more tags than slots.
// Cycle-accurate model: models/tactile_depth/chip/depth/frame_tags.py.

`default_nettype none

module frame_tags
  import td_config_pkg::*;
#(
  parameter int Width   = 34,
  parameter int Latency = value(DefaultConfig, FrameLatencyField),  // from a frame's last pixel to its first depth, > 1
  parameter int Pixels  = value(DefaultConfig, RowsField) * value(DefaultConfig, ColumnsField)
) (
  input  wire              clk,
  input  wire              rst,
  input  wire              en,
  input  wire              push,
  input  wire  [Width-1:0] tag,
  output logic             due,
  output logic [Width-1:0] due_tag,
  output logic             held     // there are tags
);

  localparam int Slots = (Latency + Pixels - 1) / Pixels;
  localparam int SlotWidth = Slots > 1 ? $clog2(Slots) : 1;
  localparam int ClockWidth = $clog2(Latency + 1);

  logic [ClockWidth-1:0] now, due_clock[Slots];  // due_clock: the enabled cycle before a tag is due
  logic [Width-1:0] tags[Slots];
  logic [Slots-1:0] full, due_here;
  logic [SlotWidth-1:0] write_slot;

  always_comb begin
    due_tag = '0;
    for (int i = 0; i < Slots; i++) due_tag = due_tag | (due_here[i] ? tags[i] : '0);
  end
  assign due = |due_here;
  assign held = |full;

  always_ff @(posedge clk) begin
    if (en) begin
      now <= now + ClockWidth'(1);
      full <= full & ~due_here;
      for (int i = 0; i < Slots; i++) due_here[i] <= full[i] & (due_clock[i] == now);
      if (push) begin
        tags[write_slot] <= tag;
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
