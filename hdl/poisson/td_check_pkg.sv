// SPDX-License-Identifier: Apache-2.0
// td_check_pkg: the sums of a row by which a frame checks itself.

`default_nettype none

package td_check_pkg;

  // The sums that a column is a part of. The first is of all but the last, the others are of those with a minus sign in
  // a pattern, which the first column is not. Signs are Rudin and Shapiro's, each of them 1, 2 or 4 times; those of the
  // last pattern are mirrored, and opposite, in the right half.
  localparam int CheckSums = 4;
  function automatic logic [CheckSums-1:0] check_sums(input logic [9:0] column, input int columns);
    logic [9:0] pairs, folded, folded_pairs;
    logic right;
    right = column >= 10'($unsigned(columns / 2));
    folded = right ? 10'($unsigned(columns - 1)) & ~column : column;
    pairs = column & column >> 1;
    folded_pairs = folded & folded >> 1;
    check_sums = {^(folded_pairs >> 2) ^ right, ^(pairs >> 1), ^pairs, 1'b1}
        & {CheckSums{column != 10'(columns - 1)}};
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
