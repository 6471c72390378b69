// SPDX-License-Identifier: Apache-2.0
// ram_check: conditions under which hdl/common/td_ram.sv may be used. A proof binds it to a ram; in simulation
// (TD_SIMULATED) each memory has one, and the first clock that breaks a rule ends the run.
//
// No word is read in the clock that writes it, and none beyond the depth is written. Proofs add what simulation shows as
// unknown values, where they are used: no word beyond the depth is read, and (Defined) none before it was written.
// Nothing counts before the end of the reset at power-up: one clock of a bench, some clocks until that of a board is seen.

`default_nettype none

module ram_check #(
  parameter int Depth   = 8,
  parameter int Defined = 1,
  parameter int Covered = 1,  // cover the read of the last word
  localparam int AddressWidth = $clog2(Depth)
) (
  input logic                    clk,
  input logic                    write_en,
  input logic [AddressWidth-1:0] write_address,
  input logic                    read_en,
  input logic [AddressWidth-1:0] read_address
);

`ifdef TD_SIMULATED
  localparam int PowerUp = 16;  // clocks
`else
  localparam int PowerUp = 1;
`endif
  logic [$clog2(PowerUp + 1)-1:0] clocks = '0;
  logic started;
  assign started = 32'(clocks) == PowerUp;
  always_ff @(posedge clk) if (!started) clocks <= clocks + 1'b1;

  logic write_outside, collision;
  assign write_outside = started && write_en && 32'(write_address) >= Depth;
  assign collision = started && read_en && write_en && read_address == write_address;

`ifdef TD_SIMULATED
  always @(posedge clk) begin
    if (write_outside) $fatal(1, "word %0d of %0d is written", write_address, Depth);
    if (collision) $fatal(1, "word %0d is read in the clock that writes it", read_address);
  end
`else
  logic [Depth-1:0] written = '0;
  always_ff @(posedge clk) if (started && write_en) written[write_address] <= 1'b1;
  always_comb begin
    write_inside: assert (!write_outside);
    no_collision: assert (!collision);
    if (started && read_en) begin
      read_inside: assert (32'(read_address) < Depth);
      if (Defined != 0) written_before: assert (written[read_address]);
      if (Covered != 0) last_word_read: cover (read_address == AddressWidth'(Depth - 1));
    end
  end
`endif

endmodule

`default_nettype wire
