// SPDX-License-Identifier: Apache-2.0
// td_rom: read-only memory, whose words come from a file. Read latency: 1 cycle.
//
// Contents come from File (one line per word, $readmemh), written by models/tactile_depth/chip/rom_files.py.
// Bit-accurate model: models/tactile_depth/chip/common/td_rom.py.

`default_nettype none

module td_rom #(
  parameter int Width = 54,
  parameter int Depth = 128,
  parameter int Style = 3,  // 0: distributed, 1: block, 3: block above DistributedBits, else distributed
  parameter     File  = "rom.hex",
  localparam int AddressWidth = $clog2(Depth)
) (
  input  wire                     clk,
  input  wire                     en,
  input  wire  [AddressWidth-1:0] address,
  output logic [Width-1:0]        data
);

  if (Style == 0 || (Style == 3 && Width * Depth <= td_memory_pkg::DistributedBits)) begin : g_distributed
    (* rom_style = "distributed" *) logic [Width-1:0] words[Depth];
    initial $readmemh(File, words);
    always_ff @(posedge clk) if (en) data <= words[address];
  end else begin : g_block
    (* rom_style = "block" *) logic [Width-1:0] words[Depth];
    initial $readmemh(File, words);
    always_ff @(posedge clk) if (en) data <= words[address];
  end

  if (Depth < 2) begin : g_refused
    Depth_must_be_at_least_2 u_refused ();
  end

`ifndef SYNTHESIS
  // synthesis translate_off
  initial begin : g_there
    string missing;
    missing = td_tables_pkg::missing(File);
    if (missing != "") $fatal(1, "%0s", missing);
  end
  // synthesis translate_on
`endif

endmodule

`default_nettype wire
