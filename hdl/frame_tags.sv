// SPDX-License-Identifier: Apache-2.0
// frame_tags: what is known of each frame travels beside the solver, in a short queue.
//
// A tag is pushed with the last pixel of a frame and taken off with its first depth; head is the oldest tag. The solver
// keeps the order of frames, so a queue is enough. Depth 4: at most three frames lie between these two events, at the
// smallest grid. Cycle-accurate model: models/frame_tags.py, a queue.

module frame_tags #(
  parameter int Width = 33
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             push,
  input  logic [Width-1:0] tag,
  input  logic             pop,
  output logic [Width-1:0] head
);

  logic [Width-1:0] tags[4];
  logic [1:0] write_place, read_place;
  assign head = tags[read_place];

  always_ff @(posedge clk) begin
    if (push) begin
      tags[write_place] <= tag;
      write_place <= write_place + 2'd1;
    end
    if (pop) read_place <= read_place + 2'd1;
    if (rst) begin
      write_place <= '0;
      read_place <= '0;
    end
  end

`ifndef SYNTHESIS
  logic [2:0] held;
  always @(posedge clk) begin
    held <= held + 3'(push) - 3'(pop);
    if (rst) held <= '0;
    if (!rst && push && !pop && held == 3'd4) $fatal(1, "%m: the queue is full");
    if (!rst && pop && held == 3'd0) $fatal(1, "%m: the queue is empty");
  end
`endif

endmodule
