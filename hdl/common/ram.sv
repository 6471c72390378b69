// SPDX-License-Identifier: Apache-2.0
// ram: simple dual-port memory, one write and one read port, on one clock. Read latency: 1 cycle.
//
// The one place to put a memory macro. Nobody reads a word in the cycle that writes it, so what such a read returns is
// left open. A File (one line per word, $readmemh) gives the contents at power-up.
// Bit-accurate model: models/tactile_depth/common/ram.py.

module ram #(
  parameter int Width = 24,
  parameter int Depth = 16384,
  parameter int Style = 1,  // 0: distributed, 1: block, 2: ultra
  parameter     File  = "",
  localparam int AddressWidth = $clog2(Depth)
) (
  input  logic                    clk,
  input  logic                    write_en,
  input  logic [AddressWidth-1:0] write_address,
  input  logic [Width-1:0]        write_data,
  input  logic                    read_en,
  input  logic [AddressWidth-1:0] read_address,
  output logic [Width-1:0]        read_data
);

  case (Style)  // not else if: Yosys' own front end would count that as a scope
    0: begin : g_distributed
      (* ram_style = "distributed", no_rw_check *) logic [Width-1:0] words[Depth];
      if (File != "") begin : g_file
        initial $readmemh(File, words);
      end
      always_ff @(posedge clk) begin
        if (write_en) words[write_address] <= write_data;
        if (read_en) read_data <= words[read_address];
      end
    end
    1: begin : g_block
      (* ram_style = "block", no_rw_check *) logic [Width-1:0] words[Depth];
      if (File != "") begin : g_file
        initial $readmemh(File, words);
      end
      always_ff @(posedge clk) begin
        if (write_en) words[write_address] <= write_data;
        if (read_en) read_data <= words[read_address];
      end
    end
    default: begin : g_ultra
      (* ram_style = "ultra", no_rw_check *) logic [Width-1:0] words[Depth];
      always_ff @(posedge clk) begin
        if (write_en) words[write_address] <= write_data;
        if (read_en) read_data <= words[read_address];
      end
    end
  endcase

`ifndef SYNTHESIS
  initial begin
    if (Depth < 2) $fatal(1, "%m: Depth must be at least 2");
    if (Style == 2 && File != "") $fatal(1, "%m: an ultra memory has no contents at power-up");
  end
`endif

endmodule
