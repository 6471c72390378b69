// SPDX-License-Identifier: Apache-2.0
// frame_tags: what is known of each frame waits beside the solver until its first depth is due.
//
// A tag is pushed with the last pixel of a frame. Latency enabled clocks later `due` is high for one enabled clock,
// with the tag on due_tag. No order is kept: each place compares the clock with its own, so an upset costs the frame it
// hits and no other. Pushes lie at least Pixels enabled clocks apart, so there are never more tags than places.
// Cycle-accurate model: models/tactile_depth/frame/frame_tags.py.

module frame_tags #(
  parameter int Width   = 33,
  parameter int Latency = 17167,  // of the solver and what lies before it, from a frame's last pixel to its first depth
  parameter int Pixels  = 16384   // of a frame
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic             push,
  input  logic [Width-1:0] tag,
  output logic             due,
  output logic [Width-1:0] due_tag,
  output logic             held     // there are tags
);

  localparam int Places = (Latency + Pixels - 1) / Pixels;
  localparam int PlaceWidth = Places > 1 ? $clog2(Places) : 1;
  localparam int ClockWidth = $clog2(Latency + 1);

  logic [ClockWidth-1:0] now, due_clock[Places];
  logic [Width-1:0] tags[Places];
  logic [Places-1:0] full, due_here;
  logic [PlaceWidth-1:0] write_place;

  always_comb begin
    due_tag = '0;
    for (int i = 0; i < Places; i++) begin
      due_here[i] = full[i] & (due_clock[i] == now);
      due_tag = due_tag | (due_here[i] ? tags[i] : '0);
    end
  end
  assign due = |due_here;
  assign held = |full;

  always_ff @(posedge clk) begin
    if (en) begin
      now <= now + ClockWidth'(1);
      full <= full & ~due_here;
      if (push) begin
        tags[write_place] <= tag;
        due_clock[write_place] <= now + ClockWidth'(Latency);
        full[write_place] <= 1'b1;
        write_place <= write_place == PlaceWidth'(Places - 1) ? '0 : write_place + PlaceWidth'(1);
      end
    end
    if (rst) begin
      now <= '0;
      full <= '0;
      write_place <= '0;
    end
  end

endmodule
