// SPDX-License-Identifier: Apache-2.0
// axil_client: on each channel of an AXI4-Lite port, what is offered stays until it is taken.

`default_nettype none

module axil_client #(
  parameter int AddressWidth = 10
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    reset,
  input  logic [AddressWidth-1:0] awaddr,
  input  logic                    awvalid,
  input  logic                    awready,
  input  logic [31:0]             wdata,
  input  logic [3:0]              wstrb,
  input  logic                    wvalid,
  input  logic                    wready,
  input  logic [AddressWidth-1:0] araddr,
  input  logic                    arvalid,
  input  logic                    arready,
  output logic                    holds
);

  logic write_address_stays, write_stays, read_address_stays;
  assign holds = write_address_stays & write_stays & read_address_stays;
  offer_stays #(.Width(AddressWidth)) u_write_address (
    .clk, .rst, .reset, .valid(awvalid), .ready(awready), .word(awaddr), .holds(write_address_stays)
  );
  offer_stays #(.Width(36)) u_write (
    .clk, .rst, .reset, .valid(wvalid), .ready(wready), .word({wstrb, wdata}), .holds(write_stays)
  );
  offer_stays #(.Width(AddressWidth)) u_read_address (
    .clk, .rst, .reset, .valid(arvalid), .ready(arready), .word(araddr), .holds(read_address_stays)
  );

endmodule

`default_nettype wire
