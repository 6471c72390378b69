// SPDX-License-Identifier: Apache-2.0
// rom: read-only memory. Read latency: 1 cycle.
//
// Contents come from File (one line per word, $readmemh), written by models/tactile_depth/rom_files.py.
// Bit-accurate model: models/tactile_depth/common/rom.py.

module rom #(
  parameter int Width = 54,
  parameter int Depth = 128,
  parameter     File  = "rom.hex",
  localparam int AddressWidth = $clog2(Depth)
) (
  input  logic                    clk,
  input  logic                    en,
  input  logic [AddressWidth-1:0] address,
  output logic [Width-1:0]        data
);

  localparam int SmallBits = 4096;  // below this LUTs are cheaper than a block RAM

  if (Width * Depth <= SmallBits) begin : g_distributed
    (* rom_style = "distributed" *) logic [Width-1:0] words[Depth];
    initial $readmemh(File, words);
    always_ff @(posedge clk) if (en) data <= words[address];
  end else begin : g_block
    (* rom_style = "block" *) logic [Width-1:0] words[Depth];
    initial $readmemh(File, words);
    always_ff @(posedge clk) if (en) data <= words[address];
  end

`ifndef SYNTHESIS
  initial if (Depth < 2) $fatal(1, "%m: Depth must be at least 2");
`endif

endmodule
