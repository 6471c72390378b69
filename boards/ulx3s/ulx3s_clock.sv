// SPDX-License-Identifier: Apache-2.0
// ulx3s_clock: the pipeline's clock from the board's 25 MHz. In simulation the clock that comes in is that of the
// pipeline, locked after a few of its edges. No model: there is nothing to compute.

`default_nettype none

module ulx3s_clock #(
  parameter int ClockMhz = 100
) (
  input  wire  clk_25mhz,
  output logic clk,
  output logic locked
);

`ifdef SYNTHESIS
  localparam int OscillatorMhz = 25;
  localparam int VcoMhz = 600;  // of 400 to 800

  (* ICP_CURRENT = "12", LPF_RESISTOR = "8", MFG_ENABLE_FILTEROPAMP = "1", MFG_GMCREF_SEL = "2" *)
  EHXPLLL #(
    .CLKI_DIV(1), .CLKFB_DIV(ClockMhz / OscillatorMhz), .FEEDBK_PATH("CLKOP"),
    .CLKOP_ENABLE("ENABLED"), .CLKOP_DIV(VcoMhz / ClockMhz), .CLKOP_CPHASE(VcoMhz / ClockMhz - 1), .CLKOP_FPHASE(0),
    .PLLRST_ENA("DISABLED"), .INTFB_WAKE("DISABLED"), .STDBY_ENABLE("DISABLED"), .DPHASE_SOURCE("DISABLED"),
    .OUTDIVIDER_MUXA("DIVA"), .OUTDIVIDER_MUXB("DIVB"), .OUTDIVIDER_MUXC("DIVC"), .OUTDIVIDER_MUXD("DIVD")
  ) u_pll (
    .CLKI(clk_25mhz), .CLKOP(clk), .CLKFB(clk), .LOCK(locked), .RST(1'b0), .STDBY(1'b0), .ENCLKOP(1'b0),
    .PHASESEL0(1'b0), .PHASESEL1(1'b0), .PHASEDIR(1'b1), .PHASESTEP(1'b1), .PHASELOADREG(1'b1), .PLLWAKESYNC(1'b0)
  );
`else
  localparam int LockClocks = 4;
  logic [2:0] edges = '0;
  assign clk = clk_25mhz;
  assign locked = edges == 3'(LockClocks);
  always_ff @(posedge clk_25mhz) if (!locked) edges <= edges + 3'd1;

`endif

  if (ClockMhz < 25 || ClockMhz % 25 != 0 || 600 % ClockMhz != 0) begin : g_refused
    ClockMhz_must_be_a_multiple_of_25_that_divides_600 u_refused ();
  end

endmodule

`default_nettype wire
