// SPDX-License-Identifier: Apache-2.0
// td_ram, in place of the core td_ram on an ECP5, whose block memories hold 16,384 bits: 4,096 words of 4 bits, for
// example.
//
// Block memories of more than 2,048 words are built of slices, each as wide as one block memory. Without them Yosys
// takes wider block memories of fewer words, and selects between them after the read: a longer path, and more routes.
// A slice has a File of its own at power-up, which the flow writes (`write_slices` of commands/hardware/ecp5.py).

`default_nettype none

module td_ram #(
  parameter int Width = 24,
  parameter int Depth = 16384,
  parameter int Style = 3,  // as in hdl/common/td_ram.sv; ultra is block
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

  localparam int Block = 16384;
  localparam int SliceWidth = Block >> AddressWidth;

  if (Style == 0 || (Style == 3 && Width * Depth <= td_memory_pkg::DistributedBits)) begin : g_distributed
    (* ram_style = "distributed", no_rw_check *) logic [Width-1:0] words[Depth];
    if (File != "") begin : g_file
      initial $readmemh(File, words);
    end
    always_ff @(posedge clk) begin
      if (write_en) words[write_address] <= write_data;
      if (read_en) read_data <= words[read_address];
    end
  end else if (Depth <= 2048 || Depth > Block) begin : g_block
    (* ram_style = "block", no_rw_check *) logic [Width-1:0] words[Depth];
    if (File != "") begin : g_file
      initial $readmemh(File, words);
    end
    always_ff @(posedge clk) begin
      if (write_en) words[write_address] <= write_data;
      if (read_en) read_data <= words[read_address];
    end
  end else begin : g_slices
    for (genvar s = 0; s * SliceWidth < Width; s++) begin : g_slice
      localparam int Low = s * SliceWidth;
      localparam int Bits = Width - Low < SliceWidth ? Width - Low : SliceWidth;
      (* ram_style = "block", no_rw_check *) logic [Bits-1:0] words[Depth];
      if (File != "") begin : g_file
        initial $readmemh({File, ".", "0" + 8'(s / 10), "0" + 8'(s % 10)}, words);
      end
      always_ff @(posedge clk) begin
        if (write_en) words[write_address] <= write_data[Low+:Bits];
        if (read_en) read_data[Low+:Bits] <= words[read_address];
      end
    end
  end

`ifdef TD_SIMULATED
  ram_check #(.Depth(Depth), .Defined(0)) u_check (.clk, .write_en, .write_address, .read_en, .read_address);
`endif

endmodule

`default_nettype wire
