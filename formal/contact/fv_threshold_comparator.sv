// SPDX-License-Identifier: Apache-2.0
// fv_threshold_comparator: contact rises in the clock after a depth above the threshold leaves, and at no other time;
// it falls in the clock after the first depth of a frame, if that is not above and hold is low, and at no other time.
//
// Assumed: what leaves first after a reset is the first depth of a frame (frame_output sends whole frames).

module fv_threshold_comparator #(
  parameter int Width = 24
) (
  input logic                    clk,
  input logic                    rst,
  input logic                    in_valid,
  input logic                    in_user,
  input logic signed [Width-1:0] in_data,
  input logic signed [31:0]      threshold,
  input logic                    hold
);

  logic contact;
  threshold_comparator #(.Width(Width)) dut (
    .clk, .rst, .in_valid, .in_user, .in_data, .threshold, .hold, .contact
  );

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  logic framed;  // a frame has begun since reset
  logic signed [31:0] of_frame, in_force;  // threshold when the frame began; that which counts now
  assign in_force = in_valid & in_user ? threshold : of_frame;
  logic signed [33:0] excess;
  assign excess = 34'(in_data) - 34'(in_force);

  logic fired, cleared, contact_q, within_frame;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    framed <= ~rst & (framed | (in_valid & in_user));
    of_frame <= in_force;
    fired <= ~rst & in_valid & (excess > 0);
    cleared <= rst | (in_valid & in_user & ~hold & (excess <= 0));
    within_frame <= framed & in_valid & ~in_user;
    contact_q <= contact;
  end
  always_comb if (in_valid && !framed) assume (in_user);

  always_comb begin
    if (started) begin
      if (fired) fires_in_one_clock: assert (contact);
      else if (cleared) clears: assert (!contact);
      else keeps: assert (contact == contact_q);
      fires_late: cover (fired && within_frame && !contact_q && of_frame < 0);
      refires: cover (fired && contact_q && !within_frame);
      holds: cover (contact && !fired && !within_frame && in_valid && in_user);
      falls: cover (contact_q && !contact);
    end
  end

endmodule
