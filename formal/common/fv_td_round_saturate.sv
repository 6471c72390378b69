// SPDX-License-Identifier: Apache-2.0
// fv_td_round_saturate: rounding and saturation over every input.
//
// The specification knows no bit of the implementation. An integer is the rounded value of in / 2^Drop if it lies
// nearer than half a step, or at half a step and is even. There is exactly one such integer for every input, so what
// holds of an arbitrary integer, should it be the one, holds of all inputs.

parameter int InWidth = 48, Drop = 17, OutWidth = 27;
localparam int IntegerWidth = InWidth - Drop + 1;
input logic signed [IntegerWidth-1:0] asked;  // an arbitrary integer

localparam int Up = Drop < 0 ? -Drop : 0, Down = Drop > 0 ? Drop : 0, Wide = InWidth + Up + OutWidth + 4;
localparam logic signed [Wide-1:0] One = 1;
localparam logic signed [Wide-1:0] Step = One <<< Down;
localparam logic signed [Wide-1:0] Largest = (One <<< (OutWidth - 1)) - One;
localparam logic signed [Wide-1:0] Smallest = -(One <<< (OutWidth - 1));
localparam int Clips = InWidth - Drop + (Drop > 0 ? 1 : 0) > OutWidth ? 1 : 0;  // a carry out of the top, too

// Twice the distance from in to what is asked about.
logic signed [Wide-1:0] twice_error;
logic rounded, half_below, half_above;
assign twice_error = ((Wide'(asked) <<< Down) - (Wide'(in) <<< Up)) <<< 1;
assign half_below = Drop > 0 && twice_error == -Step;
assign half_above = Drop > 0 && twice_error == Step;
assign rounded = twice_error == 0
    || (Drop > 0 && twice_error > -Step && twice_error < Step)
    || ((half_below || half_above) && !asked[0]);

always_comb begin
  if (rounded) begin
    if (Wide'(asked) > Largest) above: assert (Wide'(out) == Largest && clipped);
    else if (Wide'(asked) < Smallest) below: assert (Wide'(out) == Smallest && clipped);
    else unclipped: assert (Wide'(out) == Wide'(asked) && !clipped);
  end
  positive: cover (rounded && !clipped && out > 0);
  negative: cover (rounded && !clipped && out < 0);
  if (Drop > 0) begin
    tie_up: cover (rounded && half_above && out > 0);
    tie_down: cover (rounded && half_below && out < 0);
  end
  if (Clips != 0) begin
    clips_above: cover (rounded && clipped && Wide'(asked) > Largest);
    if (InWidth - Drop > OutWidth) clips_below: cover (rounded && clipped && Wide'(asked) < Smallest);
  end
end
