// SPDX-License-Identifier: Apache-2.0
// td_ram: memory with one write and one read port, on one clock. Read latency: 1 cycle.
//
// The one place to put a memory macro. A core must not read a word in the cycle that writes it: what such a read
// returns is undefined. A File (one line per word, $readmemh) gives the contents at power-up.
// Bit-accurate model: models/tactile_depth/chip/common/td_ram.py.

`default_nettype none

module td_ram #(
  parameter int Width = 24,
  parameter int Depth = 16384,
  parameter int Style = 3,  // 0: distributed, 1: block, 2: ultra, 3: block above DistributedBits, else distributed
  parameter     File  = "",
  localparam int AddressWidth = $clog2(Depth)
) (
  input  wire                     clk,
  input  wire                     write_en,
  input  wire  [AddressWidth-1:0] write_address,
  input  wire  [Width-1:0]        write_data,
  input  wire                     read_en,
  input  wire  [AddressWidth-1:0] read_address,
  output logic [Width-1:0]        read_data
);

  localparam int Built = Style != 3 ? Style : Width * Depth > td_memory_pkg::DistributedBits ? 1 : 0;

  case (Built)  // not else if: Yosys' own front end would count that as a scope
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

  if (Depth < 2) begin : g_refused_0
    Depth_must_be_at_least_2 u_refused ();
  end
  if (Style == 2 && File != "") begin : g_refused_1
    an_ultra_memory_has_no_contents_at_power_up u_refused ();
  end

`ifdef TD_SIMULATED
  ram_check #(.Depth(Depth), .Defined(0)) u_check (.clk, .write_en, .write_address, .read_en, .read_address);
`endif

`ifndef SYNTHESIS
  // synthesis translate_off
  initial begin : g_there
    string missing;
    missing = "";
    if (File != "") missing = td_tables_pkg::missing(File);
    if (missing != "") $fatal(1, "%0s", missing);
  end
  // synthesis translate_on
`endif

endmodule

`default_nettype wire
