// SPDX-License-Identifier: Apache-2.0
// protocol_table_access: no access, and no other table, in the clock before an access; no write in a reset.

module protocol_table_access;
  logic asked, accessed, answered;  // asked: an access of a read
  logic [1:0] select_q;
  assign holds = ~(read & (asked | write)) & ~(write & (asked | accessed)) & (~(asked | write) | (select == select_q));
  assign given_write = write & ~rst;
  always_ff @(posedge clk) begin
    asked <= read & read_late & ~reset;
    accessed <= asked | write | reset;
    select_q <= select;
    answered <= (answered | asked) & ~reset;
  end
  assign counts = live;
  assign counts_write_refused = live & write;
  assign {counts_late_data, counts_late_refused} = {2{live & answered & ~asked}};
endmodule
