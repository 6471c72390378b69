// SPDX-License-Identifier: Apache-2.0
// protocol_table_access: no access in the clock after a read of a table; no write in a reset.

module protocol_table_access;
  logic asked, answered;
  assign holds = ~(asked & (read | write));
  assign given_write = write & ~rst;
  always_ff @(posedge clk) begin
    asked <= read & read_late & ~reset;
    answered <= (answered | asked) & ~reset;
  end
  assign counts = live;
  assign {counts_late_data, counts_late_refused} = {2{live & answered & ~asked}};
endmodule
