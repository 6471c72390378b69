// SPDX-License-Identifier: Apache-2.0
// ram_check: conditions under which hdl/common/td_ram.sv may be used. A bench binds it to a ram.
//
// No word is read in the clock that writes it, and (Defined) none before it was written. Power-up is the first clock,
// which a bench spends in reset: nothing counts before its end.

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

  logic started = 1'b0;
  logic [Depth-1:0] written = '0;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    if (started && write_en) written[write_address] <= 1'b1;
  end

  always_comb begin
    if (started && read_en) begin
      read_inside: assert (32'(read_address) < Depth);
      no_collision: assert (!(write_en && read_address == write_address));
      if (Defined != 0) written_before: assert (written[read_address]);
      if (Covered != 0) last_word_read: cover (read_address == AddressWidth'(Depth - 1));
    end
    if (started && write_en) write_inside: assert (32'(write_address) < Depth);
  end

endmodule

`default_nettype wire
