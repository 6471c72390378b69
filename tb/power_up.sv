// SPDX-License-Identifier: Apache-2.0
// power_up: a register and a memory that no reset touches, as seen before anything was written. Simulation only.

`default_nettype none

module power_up (
  input  wire         clk,
  input  wire  [3:0]  address,
  output logic [31:0] kept,
  output logic [31:0] word
);

  always_ff @(posedge clk) kept <= kept;

  td_ram #(.Width(32), .Depth(16)) u_ram (
    .clk, .write_en(1'b0), .write_address('0), .write_data('0), .read_en(1'b1), .read_address(address),
    .read_data(word)
  );

endmodule

`default_nettype wire
