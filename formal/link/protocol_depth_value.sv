// SPDX-License-Identifier: Apache-2.0
// protocol_depth_value: one code a value, or up to four of a mean; shifts up to 16. The value counts from 3 clocks behind
// its last code until 3 clocks behind the first code of the next.

`default_nettype none

module protocol_depth_value (
  input  logic       clk,
  input  logic       average,
  input  logic [4:0] shift,
  input  logic       in_valid,
  input  logic       in_first,
  output logic       holds,
  output logic       counts
);

  logic [2:0] codes = '0;  // of the value
  logic mean = 1'b0, complete, complete_q = 1'b0, complete_q2 = 1'b0;
  assign holds = shift <= 5'd16 & (~in_valid | in_first | (average & mean & codes != '0 & codes < 3'd4));
  assign complete = codes == (mean ? 3'd4 : 3'd1);
  assign counts = complete_q2;
  always_ff @(posedge clk) begin
    if (in_valid && holds) begin
      codes <= in_first ? 3'd1 : codes + 3'd1;
      mean <= average;
    end
    complete_q <= complete & holds;
    complete_q2 <= complete_q;
  end

endmodule

`default_nettype wire
