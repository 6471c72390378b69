// SPDX-License-Identifier: Apache-2.0
// protocol_td_ram: addresses within the memory; no read of the word that is being written.

`default_nettype none

module protocol_td_ram #(
  parameter int Depth = 16384,
  localparam int AddressWidth = $clog2(Depth)
) (
  input  logic                    write_en,
  input  logic [AddressWidth-1:0] write_address,
  input  logic                    read_en,
  input  logic [AddressWidth-1:0] read_address,
  output logic                    holds
);

  localparam logic [AddressWidth:0] End = Depth;
  assign holds = ~(read_en & write_en & read_address == write_address)
      & (~read_en | {1'b0, read_address} < End) & (~write_en | {1'b0, write_address} < End);

endmodule

`default_nettype wire
