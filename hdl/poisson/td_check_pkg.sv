// SPDX-License-Identifier: Apache-2.0
// td_check_pkg: the sums of a row by which a frame checks itself.

`default_nettype none

package td_check_pkg;

  // The sums that a column is a part of. The first is of all inner columns, the others are of those with a minus sign in
  // a pattern. Signs are Rudin and Shapiro's, each of them 1, 2 or 4 times.
  localparam int CheckSums = 4;
  function automatic logic [CheckSums-1:0] check_sums(input logic [9:0] column, input int columns);
    logic [9:0] pairs;
    pairs = column & column >> 1;
    check_sums = {^(pairs >> 2), ^(pairs >> 1), ^pairs, column != 0} & {CheckSums{column != 10'(columns - 1)}};
  endfunction

  // Half of the columns of one of these sums.
  function automatic int check_half(input logic [1:0] sum, input int columns);
    int column, count;
    logic [CheckSums-1:0] sums;
    count = 0;
    for (column = 0; column < columns; column = column + 1) begin
      sums = check_sums(10'(column), columns);
      count = count + 32'(sums[sum]);
    end
    check_half = count / 2;
  endfunction

endpackage

`default_nettype wire
