// SPDX-License-Identifier: Apache-2.0
// threshold_comparator: contact, one clock after the deciding depth value leaves.
//
//   contact <- 1 when a depth above the threshold leaves
//   contact <- 0 when the first depth of a frame leaves, unless hold; setting wins over clearing
//
// Stream in: depth codes as they leave (valid and ready together); it never stalls them. A threshold written inside a
// frame counts from the next one on. Latency: 1 cycle. Bit-accurate model:
// models/tactile_depth/contact/threshold_comparator.py.

module threshold_comparator #(
  parameter int Width = 24
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    in_valid,
  input  logic                    in_user,    // first depth of a frame
  input  logic signed [Width-1:0] in_data,
  input  logic signed [31:0]      threshold,
  input  logic                    hold,
  output logic                    contact
);

  logic signed [31:0] threshold_q, threshold_now;
  assign threshold_now = in_user ? threshold : threshold_q;

  logic above;
  assign above = 32'(in_data) > threshold_now;

  always_ff @(posedge clk) begin
    if (in_valid) begin
      threshold_q <= threshold_now;
      if (above) contact <= 1'b1;
      else if (in_user && !hold) contact <= 1'b0;
    end
    if (rst) contact <= 1'b0;
  end

`ifndef SYNTHESIS
  initial if (Width < 2 || Width > 32) $fatal(1, "%m: Width must be 2 to 32");
`endif

endmodule
