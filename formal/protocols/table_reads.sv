// SPDX-License-Identifier: Apache-2.0
// table_reads: what is read from a table stands two clocks after it is asked for.

`default_nettype none

module table_reads (
  input  logic clk,
  input  logic reset,
  input  logic table_read,
  output logic idle,   // no read is under way
  output logic stands  // what was read last stands
);

  logic [1:0] left = '0;
  logic read = 1'b0;
  assign idle = left == '0;
  assign stands = read & idle;
  always_ff @(posedge clk) begin
    left <= table_read ? 2'd1 : idle ? '0 : left - 2'd1;
    read <= read | table_read;
    if (reset) begin
      left <= '0;
      read <= 1'b0;
    end
  end

endmodule

`default_nettype wire
