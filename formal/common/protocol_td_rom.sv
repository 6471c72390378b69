// SPDX-License-Identifier: Apache-2.0
// protocol_td_rom: addresses within the memory; data count once one enabled clock has passed.

`default_nettype none

module protocol_td_rom #(
  parameter int Depth = 128,
  localparam int AddressWidth = $clog2(Depth)
) (
  input  logic                    clk,
  input  logic                    en,
  input  logic [AddressWidth-1:0] address,
  output logic                    holds,
  output logic                    counts_data
);

  assign holds = (AddressWidth + 1)'(address) < (AddressWidth + 1)'(Depth);
  settled #(.Clocks(1)) u_settled (.clk, .en(en & holds), .settled(counts_data));

endmodule

`default_nettype wire
