// SPDX-License-Identifier: Apache-2.0
// protocol_axil_registers: the client keeps to AXI4-Lite; anything on all other inputs.

`default_nettype none

module protocol_axil_registers
  import td_register_map_pkg::*;
(
  input  logic                    clk,
  input  logic                    rst,
  input  logic [AddressWidth-1:0] s_axil_awaddr,
  input  logic                    s_axil_awvalid,
  input  logic                    s_axil_awready,
  input  logic [31:0]             s_axil_wdata,
  input  logic [3:0]              s_axil_wstrb,
  input  logic                    s_axil_wvalid,
  input  logic                    s_axil_wready,
  input  logic                    s_axil_bvalid,
  input  logic [AddressWidth-1:0] s_axil_araddr,
  input  logic                    s_axil_arvalid,
  input  logic                    s_axil_arready,
  input  logic                    s_axil_rvalid,
  output logic                    holds,
  output logic                    counts_s_axil_bresp,
  output logic                    counts_s_axil_rdata,
  output logic                    counts_s_axil_rresp,
  output logic                    counts
);

  logic reset, live = 1'b0;
  assign reset = rst | ~holds;
  always_ff @(posedge clk) live <= live | reset;
  axil_client #(.AddressWidth(AddressWidth)) u_client (.*);
  assign counts = live;
  assign counts_s_axil_bresp = live & s_axil_bvalid;
  assign {counts_s_axil_rdata, counts_s_axil_rresp} = {2{live & s_axil_rvalid}};

endmodule

`default_nettype wire
