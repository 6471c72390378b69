// SPDX-License-Identifier: Apache-2.0
// protocol_table_access: no access in the clock after a read of a table; no write in a reset.

`default_nettype none

module protocol_table_access (
  input  logic        clk,
  input  logic        rst,
  input  logic        write,
  input  logic        read,
  input  logic        read_late,
  output logic        given_write,
  output logic        holds,
  output logic        counts_late_data,
  output logic        counts_late_refused,
  output logic        counts
);

  logic reset, live = 1'b0, asked, answered;
  assign reset = rst | ~holds;
  assign holds = ~(asked & (read | write));
  assign given_write = write & ~rst;
  always_ff @(posedge clk) begin
    live <= live | reset;
    asked <= read & read_late & ~reset;
    answered <= (answered | asked) & ~reset;
  end
  assign counts = live;
  assign {counts_late_data, counts_late_refused} = {2{live & answered & ~asked}};

endmodule

`default_nettype wire
