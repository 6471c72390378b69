// SPDX-License-Identifier: Apache-2.0
// fv_depth_value: the value is the sum of its codes, four times the code if there is one, as td_round_saturate rounds and
// clips it for that shift; from 3 clocks behind the last code on.

parameter int DataWidth = 20;

localparam int SumWidth = DataWidth + 2, Shifts = 17;

always_comb assume (u_protocol.allowed);

logic signed [SumWidth-1:0] weighed, sum, sum_q;
logic [4:0] shift_q;
assign weighed = average ? SumWidth'(in_code) : SumWidth'(in_code) <<< 2;
always_ff @(posedge clk) begin
  if (in_valid) sum <= (in_first ? '0 : sum) + weighed;
  sum_q <= sum;
  shift_q <= shift;
end

logic signed [15:0] rounded[Shifts];
logic signed [15:0] wanted;
logic [Shifts-1:0] clipped;
for (genvar n = 0; n < Shifts; n++) begin : g_shift
  td_round_saturate #(.InWidth(SumWidth), .Drop(n + 2), .OutWidth(16)) u_round (
    .in(sum_q), .out(rounded[n]), .clipped(clipped[n])
  );
end
always_ff @(posedge clk) wanted <= rounded[shift_q];

always_comb begin
  if (u_protocol.codes != '0) same_sum: assert (dut.sum == sum);  // behind the proof
  if (u_protocol.counts) begin
    as_rounded: assert (value == wanted);
    clips: cover (value == 16'sh7fff && wanted == 16'sh7fff);
    negative: cover (value < 0 && shift_q == 5'd16);
  end
end

// Protocol: one code a value, or up to four of a mean; shifts up to 16. The value counts from 3 clocks behind its
// last code until 3 clocks behind the first code of the next.
module protocol_depth_value;
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
