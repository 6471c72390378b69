// SPDX-License-Identifier: Apache-2.0
// axil_client: on each channel of an AXI4-Lite port, what is offered stays until it is taken.

`default_nettype none

module axil_client #(
  parameter int AddressWidth = 10
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    reset,
  input  logic [AddressWidth-1:0] s_axil_awaddr,
  input  logic                    s_axil_awvalid,
  input  logic                    s_axil_awready,
  input  logic [31:0]             s_axil_wdata,
  input  logic [3:0]              s_axil_wstrb,
  input  logic                    s_axil_wvalid,
  input  logic                    s_axil_wready,
  input  logic [AddressWidth-1:0] s_axil_araddr,
  input  logic                    s_axil_arvalid,
  input  logic                    s_axil_arready,
  output logic                    holds
);

  logic address_stays, data_stays, read_stays;
  assign holds = address_stays & data_stays & read_stays;
  offer_stays #(.Width(AddressWidth)) u_write_address (
    .clk, .rst, .reset, .valid(s_axil_awvalid), .ready(s_axil_awready), .word(s_axil_awaddr), .holds(address_stays)
  );
  offer_stays #(.Width(36)) u_write (
    .clk, .rst, .reset, .valid(s_axil_wvalid), .ready(s_axil_wready), .word({s_axil_wstrb, s_axil_wdata}),
    .holds(data_stays)
  );
  offer_stays #(.Width(AddressWidth)) u_read_address (
    .clk, .rst, .reset, .valid(s_axil_arvalid), .ready(s_axil_arready), .word(s_axil_araddr), .holds(read_stays)
  );

endmodule

`default_nettype wire
