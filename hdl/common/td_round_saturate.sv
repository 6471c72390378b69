// SPDX-License-Identifier: Apache-2.0
// td_round_saturate: drops fraction bits, rounds half to even, saturates. Combinational.
//
//   out = sat_OutWidth( round( in / 2^Drop ) )          Drop <= 0: shift left, exact
//
// Rounding can carry out of the top bit (0111.1 -> 1000), so the sum keeps a guard bit and the saturation works on
// that. Bit-accurate model: models/tactile_depth/chip/common/td_round_saturate.py.

`default_nettype none

module td_round_saturate #(
  parameter int InWidth  = 46,
  parameter int Drop     = 17,
  parameter int OutWidth = 27
) (
  input  wire  signed [InWidth-1:0]  in,      // F fraction bits
  output logic signed [OutWidth-1:0] out,     // F - Drop fraction bits
  output logic                       clipped  // out is not the rounded value
);

  localparam int SumWidth = InWidth - Drop + 1;  // kept bits and a guard bit
  logic signed [SumWidth-1:0] sum;

  if (Drop > 0) begin : g_round
    // Just less than half is added, and a carry where what stays is odd: then a tie goes up. One carry chain, whose
    // lowest bit makes the carry.
    localparam logic [Drop-1:0] BelowHalf = Drop'({1'b0, {Drop{1'b1}}} >> 1);
    logic [Drop:0] unused_fraction;
    assign {sum, unused_fraction} = {in[InWidth-1], in, 1'b1} + {{SumWidth{1'b0}}, BelowHalf, in[Drop]};
  end else begin : g_shift
    assign sum = SumWidth'(in) <<< (-Drop);
  end

  if (SumWidth > OutWidth) begin : g_saturate
    assign clipped = sum[SumWidth-1:OutWidth-1] != {(SumWidth - OutWidth + 1){sum[SumWidth-1]}};
    assign out = clipped ? {sum[SumWidth-1], {(OutWidth - 1){~sum[SumWidth-1]}}} : sum[OutWidth-1:0];
  end else begin : g_extend
    assign clipped = 1'b0;
    assign out = OutWidth'(sum);
  end

  if (Drop >= InWidth) begin : g_refused_0
    Drop_must_leave_a_bit_of_the_input u_refused ();
  end
  if (OutWidth < 2) begin : g_refused_1
    OutWidth_must_be_at_least_2 u_refused ();
  end

endmodule

`default_nettype wire
