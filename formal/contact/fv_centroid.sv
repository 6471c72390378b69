// SPDX-License-Identifier: Apache-2.0
// fv_centroid: done exactly Latency clocks after the last start, with both means to the nearest, ties to even. Ties need a
// weight of 32, which only the simulation has.

parameter int PositionWidth = 2, WeightWidth = 3;
parameter int Latency = 16;  // models/tactile_depth/chip/contact/centroid.py

logic [Latency-1:0] due;
logic [MomentWidth-1:0] columns, rows;
logic [WeightWidth-1:0] held;
logic [1:0] near, up;  // of column and row: the mean is 16 moment / weight, to the nearest, ties to even; rounded up
for (genvar n = 0; n < 2; n++) begin : g_mean
  localparam int Width = MeanWidth + WeightWidth + 2;
  logic [MomentWidth-1:0] moment;
  logic [MeanWidth-1:0] mean;
  logic tie;
  logic signed [Width:0] error, half;  // twice the error, times the weight
  assign moment = n == 0 ? columns : rows;
  assign mean = n == 0 ? column : row;
  assign half = $signed((Width + 1)'(held));
  assign error = $signed((Width + 1)'({moment, 5'd0})) - $signed((Width + 1)'({mean, 1'b0})) * half;
  assign up[n] = error < 0;
  assign tie = error == half | -error == half;
  assign near[n] = (error < half & -error < half) | (tie & ~mean[0]);
end
always_ff @(posedge clk) begin
  due <= Latency'({due, start});
  if (start) begin
    due <= Latency'(1);
    {columns, rows, held} <= {column_moment, row_moment, weight};
  end
  if (rst) due <= '0;
end

always_comb begin
  if (started) begin
    in_time: assert (done == due[Latency-1]);
    if (done) nearest: assert (near == '1);
    one_after_another: cover (done && start && column != row);
    rounded_up: cover (done && up[0]);
  end
end

// Protocol: row_moment and weight are held from start to done; no moment is more than the weight times the largest
// position; means count with done.
module protocol_centroid;
  logic dividing = 1'b0;
  logic [MomentWidth-1:0] held_moment, limit;
  logic [WeightWidth-1:0] held_weight;
  assign limit = {weight, PositionWidth'(0)} - MomentWidth'(weight);
  assign holds = rst | (start
      ? weight != '0 & column_moment <= limit & row_moment <= limit
      : ~dividing | (row_moment == held_moment & weight == held_weight));
  assign counts_done = live & ~reset;
  assign counts = counts_done & done;
  always_ff @(posedge clk) begin
    dividing <= ~reset & (start | (dividing & ~done));
    if (start) begin
      held_moment <= row_moment;
      held_weight <= weight;
    end
  end
endmodule
