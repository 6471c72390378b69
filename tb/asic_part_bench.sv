// SPDX-License-Identifier: Apache-2.0
// asic_part_bench: gates of a core, with delays or without, on operands that go by twice.
//
// operands.txt holds the inputs of `part`, one line per clock. With DELAYS the design takes its delays from part.sdf.
// The first pass fills the registers; toggles of the second pass go to part.vcd. Simulation only.

`timescale 1ns/1ps

`default_nettype none

module asic_part_bench #(
  parameter int  Inputs = 1,
  parameter int  Clocks = 64,    // of one pass
  parameter real Period = 10.0,
  parameter real Settle = 0.0    // from an edge to the change of the inputs
) ();

  logic clk = 1'b0;
  logic [Inputs-1:0] operands[2*Clocks];
  logic [Inputs-1:0] in;

  part part (.clk(clk), .in(in));

  initial begin
`ifdef DELAYS
    $sdf_annotate("part.sdf", part.dut);
`endif
    $readmemb("operands.txt", operands);
    in = operands[0];
    #(Period);
    for (int i = 1; i <= 2 * Clocks; i++) begin
      if (i == Clocks) begin
        $dumpfile("part.vcd");
        $dumpvars(1, part.dut);
        #(Period);  // a change in the moment of $dumpvars is lost
      end
      clk = 1'b1;
      in <= #(Settle) operands[i%(2*Clocks)];
      #(Period / 2) clk = 1'b0;
      #(Period / 2);
      if (i == 2 * Clocks - 1) $dumpoff;
    end
    $finish;
  end

endmodule

`default_nettype wire
