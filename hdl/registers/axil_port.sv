// SPDX-License-Identifier: Apache-2.0
// axil_port: an AXI4-Lite port for registers, with one write and one read in flight.
//
// Write: `write` is high in the cycle after both address and data were taken, whichever came first; the response leaves
// in the cycle after it. Read: `read` is high in the cycle after the address was taken, and read_data of that cycle
// leaves in the next; if read_late is high with `read`, late_data of 4 cycles later leaves in the cycle after that. A
// write waits while `read` is high, and for late data. A response waits for its ready, and the next one of its kind
// waits for the response. `refused`, with the data, makes the response SLVERR. No ready output depends on an input of
// the port in the same cycle. While rst is high every ready is low: no access is taken that would find no answer. A
// reset forgets those in flight, but a write that is due in its first cycle takes effect: `write` comes from a
// register, because it begins long paths. Model: models/tactile_depth/chip/registers/axil_port.py.

`default_nettype none

module axil_port
  import td_register_map_pkg::*;
#(
  parameter int Sources = 1,  // of read_data
  parameter int Copies  = 1   // of read_offset, which is far from some who read it
) (
  input  wire                     clk,
  input  wire                     rst,

  input  wire  [AddressWidth-1:0] s_axil_awaddr,
  input  wire                     s_axil_awvalid,
  output logic                    s_axil_awready,
  input  wire  [31:0]             s_axil_wdata,
  input  wire  [3:0]              s_axil_wstrb,
  input  wire                     s_axil_wvalid,
  output logic                    s_axil_wready,
  output logic [1:0]              s_axil_bresp,
  output logic                    s_axil_bvalid,
  input  wire                     s_axil_bready,
  input  wire  [AddressWidth-1:0] s_axil_araddr,
  input  wire                     s_axil_arvalid,
  output logic                    s_axil_arready,
  output logic [31:0]             s_axil_rdata,
  output logic [1:0]              s_axil_rresp,
  output logic                    s_axil_rvalid,
  input  wire                     s_axil_rready,

  output logic                    write = 1'b0,
  output logic [31:0]             write_offset,  // of the register, in bytes
  output logic [31:0]             write_ones,    // the data, 0 in bytes without strobe
  output logic [31:0]             write_mask,    // ones in bytes with strobe
  input  wire                     write_refused,
  output logic                    read = 1'b0,
  output logic [Copies-1:0][31:0] read_offset,
  input  wire  [32*Sources-1:0]   read_data,     // the word is the OR of all, behind registers
  input  wire                     read_refused,
  input  wire                     read_late,
  input  wire  [31:0]             late_data,
  input  wire                     late_refused
);

  typedef enum logic [1:0] {Okay = 2'b00, SlaveError = 2'b10} response_e;

  logic address_held = 1'b0;  // a cycle before the first reset writes no table, whose contents are from power-up
  logic data_held = 1'b0;
  logic [AddressWidth-1:0] address;
  logic [31:0] data;
  logic [3:0] strobe;
  (* dont_touch = "true" *) logic [Copies-1:0][AddressWidth-1:0] read_address;
  logic [3:0] waiting;  // for late_data, one bit a cycle
  logic [Sources-1:0][31:0] words;
  logic [31:0] any_word, late_word;
  logic is_late;

  assign s_axil_awready = !address_held && !rst;
  assign s_axil_wready = !data_held && !rst;
  assign s_axil_arready = !s_axil_rvalid && !read && waiting == '0 && !rst;
  assign write_offset = 32'(address) & ~32'd3;
  assign write_mask = {{8{strobe[3]}}, {8{strobe[2]}}, {8{strobe[1]}}, {8{strobe[0]}}};
  assign write_ones = data & write_mask;

  always_comb begin
    any_word = '0;
    for (int n = 0; n < Sources; n++) any_word = any_word | words[n];
  end
  assign s_axil_rdata = is_late ? late_word : any_word;

  for (genvar c = 0; c < Copies; c++) begin : g_copy
    assign read_offset[c] = 32'(read_address[c]) & ~32'd3;
  end
  (* keep *) always_ff @(posedge clk) begin  // tools would make one register of them
    if (s_axil_arvalid && s_axil_arready) read_address <= {Copies{s_axil_araddr}};
  end

  always_ff @(posedge clk) begin
    if (s_axil_awvalid && s_axil_awready) begin
      address_held <= 1'b1;
      address <= s_axil_awaddr;
    end
    if (s_axil_wvalid && s_axil_wready) begin
      data_held <= 1'b1;
      data <= s_axil_wdata;
      strobe <= s_axil_wstrb;
    end
    write <= (address_held || s_axil_awvalid) && (data_held || s_axil_wvalid) && !write && !s_axil_bvalid
        && waiting[2:0] == '0 && !(read && read_late) && !(s_axil_arvalid && s_axil_arready);
    if (write) begin
      s_axil_bvalid <= 1'b1;
      s_axil_bresp <= write_refused ? SlaveError : Okay;
    end
    if (s_axil_bvalid && s_axil_bready) begin
      s_axil_bvalid <= 1'b0;
      address_held <= 1'b0;
      data_held <= 1'b0;
    end

    read <= s_axil_arvalid && s_axil_arready;
    waiting <= {waiting[2:0], read && read_late};
    if (s_axil_rready) s_axil_rvalid <= 1'b0;
    if (read) begin
      words <= read_data;
      is_late <= read_late;
    end
    if (waiting[3]) late_word <= late_data;
    if ((read && !read_late) || waiting[3]) begin
      s_axil_rvalid <= 1'b1;
      s_axil_rresp <= (waiting[3] ? late_refused : read_refused) ? SlaveError : Okay;
    end

    if (rst) {address_held, data_held, write, s_axil_bvalid, s_axil_rvalid, read, waiting} <= '0;
  end

endmodule

`default_nettype wire
