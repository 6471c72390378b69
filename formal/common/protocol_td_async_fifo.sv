// SPDX-License-Identifier: Apache-2.0
// protocol_td_async_fifo: all inputs are allowed; data count while valid.

`default_nettype none

module protocol_td_async_fifo (
  input  logic read_valid,
  output logic holds,
  output logic counts_read_data
);

  assign holds = 1'b1;
  assign counts_read_data = read_valid;

endmodule

`default_nettype wire
