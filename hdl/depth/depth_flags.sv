// SPDX-License-Identifier: Apache-2.0
// depth_flags: the flags of the frame of depth that leaves: those of its slopes, and what solver and zero offset clip.
//
// A clip of the solver cannot be told apart by frame: it counts for each frame that has begun at the head of the
// pipeline and has not left. One that is entering has entering_clipped; it is kept with its tag (marked) from the last
// pixel on, until one enabled cycle after its first depth. A clip of the zero offset comes in the first cycle of its
// beat. Both come for one cycle, enabled or not. out_flags count with the last beat of a frame, which is not its first
// or second. Latency: 0 cycles. Model: models/tactile_depth/chip/depth/depth_flags.py.

`default_nettype none

module depth_flags
  import td_types_pkg::*;
(
  input  wire               clk,
  input  wire               rst,
  input  wire               en,
  input  wire               frame_start,       // the first pixel of a frame is at the head of the pipeline
  input  wire               solver_clipped,
  output logic              entering_clipped,  // with the last pixel at the head of the pipeline
  input  wire frame_flags_t in_flags,          // of the frame whose first depth left last
  input  wire               marked,            // of the same
  input  wire               zero_clipped,
  input  wire               depth_starts,      // the first beat of a frame leaves
  input  wire               depth_ends,        // the last
  output frame_flags_t      out_flags
);

  logic entering, leaving, begun, zero, zero_now;
  frame_flags_t flags;
  assign entering_clipped = entering | solver_clipped;
  assign zero_now = zero | zero_clipped;
  always_ff @(posedge clk) begin
    entering <= entering_clipped;
    leaving <= leaving | solver_clipped;
    zero <= zero_now;
    if (en) begin
      begun <= depth_starts;
      if (frame_start) entering <= 1'b0;
      if (begun) {flags, leaving} <= {in_flags, marked | solver_clipped};
      if (depth_ends) zero <= 1'b0;
    end
    if (rst) {entering, leaving, begun, zero} <= '0;
  end

  always_comb begin
    out_flags = flags;
    out_flags.depth_clipped = leaving | solver_clipped;
    out_flags.zero_clipped = zero_now;
  end

endmodule

`default_nettype wire
