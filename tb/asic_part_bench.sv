// SPDX-License-Identifier: Apache-2.0
// asic_part_bench: gates of a core, with delays or without, given what they got in the whole design.
//
// given.txt and wanted.txt hold a line for each clock: the inputs and outputs of `part` before the clock's edge.
// Registers begin with what they held then. With DELAYS it is annotated from part.sdf. Toggles go to part.vcd from the
// first edge on. Simulation only.

`timescale 1ns/1ps

module asic_part_bench #(
  parameter int  Inputs  = 1,
  parameter int  Outputs = 1,
  parameter int  Clocks  = 64,
  parameter real Period  = 10.0,
  parameter real Settle  = 0.0  // inputs follow the edge by this
) ();

  logic clk = 1'b0;
  logic [Inputs-1:0] given[Clocks];
  logic [Outputs-1:0] wanted[Clocks];
  logic [Inputs-1:0] in;
  logic [Outputs-1:0] out;

  part dut (.clk(clk), .in(in), .out(out));

  int wrong = 0;

  initial begin
`ifdef DELAYS
    $sdf_annotate("part.sdf", dut);
`endif
    $readmemb("given.txt", given);
    $readmemb("wanted.txt", wanted);
    in = given[0];
    #(Period) $dumpfile("part.vcd");
    $dumpvars(1, dut);
    #(Period);  // what happens in the moment of $dumpvars is not seen
    for (int i = 0; i < Clocks - 1; i++) begin
      if (out !== wanted[i]) wrong++;
      clk = 1'b1;
      in <= #(Settle) given[i+1];
      #(Period / 2) clk = 1'b0;
      #(Period / 2);
    end
    $dumpoff;
    $display("clocks %0d wrong %0d", Clocks - 1, wrong);
    $finish;
  end

endmodule
