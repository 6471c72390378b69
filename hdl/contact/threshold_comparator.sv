// SPDX-License-Identifier: Apache-2.0
// threshold_comparator: contact, one cycle after the beat with the deciding depth value leaves.
//
//   contact <- 1 when a depth above the threshold leaves
//   contact <- 0 when the first beat of a frame leaves, unless hold; setting wins over clearing
//   contact <- 0 when hold is cleared, unless this frame has had a depth above the threshold
//
// Stream in: depth codes as they leave (valid and ready together), Lanes of them in a beat; it never stalls them. A
// threshold written inside a frame counts from the next one on. `above` says in the cycle of a beat which of its depths
// are above. Latency: 1 cycle. Bit-accurate model: models/tactile_depth/chip/contact/threshold_comparator.py.

`default_nettype none

module threshold_comparator #(
  parameter int Width = 24,
  parameter int Lanes = 1  // depths in a beat
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     in_valid,
  input  wire                     in_frame_start,  // first beat of a frame
  input  wire  [Lanes*Width-1:0]  in_data,         // depth codes, signed
  input  wire  signed [Width:0]   threshold,       // depth code, or one beyond them
  input  wire                     hold,
  output logic [Lanes-1:0]        above,           // with each beat
  output logic                    contact
);

  logic signed [Width:0] threshold_q;  // of the frame that has begun: which one counts is chosen behind the comparison
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    logic signed [Width-1:0] depth;
    assign depth = in_data[lane*Width+:Width];
    assign above[lane] = in_frame_start ? (Width + 1)'(depth) > threshold : (Width + 1)'(depth) > threshold_q;
  end

  logic raised, raised_next;  // by a depth of this frame
  assign raised_next = in_valid ? above != '0 | (raised & ~in_frame_start) : raised;

  always_ff @(posedge clk) begin
    if (in_valid && in_frame_start) threshold_q <= threshold;
    raised <= raised_next;
    contact <= raised_next | (hold & contact);
    if (rst) begin
      raised <= 1'b0;
      contact <= 1'b0;
    end
  end

endmodule

`default_nettype wire
