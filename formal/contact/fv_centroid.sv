// SPDX-License-Identifier: Apache-2.0
// fv_centroid: done exactly Latency clocks after the last start, with both means to the nearest, ties to even. Ties need a
// weight of 32, which only the simulation has.

`default_nettype none

module fv_centroid #(
  parameter int PositionWidth = 2,
  parameter int WeightWidth   = 3,
  parameter int Latency       = 16,  // models/tactile_depth/chip/contact/centroid.py
  localparam int MomentWidth = WeightWidth + PositionWidth,
  localparam int MeanWidth = PositionWidth + 4
) (
  input logic                   clk,
  input logic                   rst,
  input logic                   start,
  input logic [MomentWidth-1:0] column_moment,
  input logic [MomentWidth-1:0] row_moment,
  input logic [WeightWidth-1:0] weight
);

  logic done;
  logic [MeanWidth-1:0] column, row;
  centroid #(.PositionWidth(PositionWidth), .WeightWidth(WeightWidth)) dut (.*);

  logic allowed, started;
  protocol_centroid #(.PositionWidth(PositionWidth), .WeightWidth(WeightWidth)) u_protocol (
    .clk, .rst, .start, .column_moment, .row_moment, .weight, .done, .holds(allowed)
  );
  assumed u_assumed (.clk, .rst, .allowed, .started);

  logic [Latency-1:0] due;
  logic [MomentWidth-1:0] columns, rows;
  logic [WeightWidth-1:0] held;
  logic column_near, row_near, column_up, unused_row_up;
  near_mean #(.MomentWidth(MomentWidth), .WeightWidth(WeightWidth), .MeanWidth(MeanWidth)) u_column (
    .moment(columns), .weight(held), .mean(column), .near(column_near), .up(column_up)
  );
  near_mean #(.MomentWidth(MomentWidth), .WeightWidth(WeightWidth), .MeanWidth(MeanWidth)) u_row (
    .moment(rows), .weight(held), .mean(row), .near(row_near), .up(unused_row_up)
  );
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
      if (done) nearest: assert (column_near && row_near);
      one_after_another: cover (done && start && column != row);
      rounded_up: cover (done && column_up);
    end
  end

endmodule

// near_mean: the mean is 16 moment / weight, to the nearest, ties to even.
module near_mean #(
  parameter int MomentWidth = 5,
  parameter int WeightWidth = 3,
  parameter int MeanWidth   = 6
) (
  input  logic [MomentWidth-1:0] moment,
  input  logic [WeightWidth-1:0] weight,
  input  logic [MeanWidth-1:0]   mean,
  output logic                   near,
  output logic                   up  // rounded up
);

  localparam int Width = MeanWidth + WeightWidth + 2;
  logic tie;
  logic signed [Width:0] error;  // twice the error, times the weight
  assign error = $signed((Width + 1)'({moment, 5'd0})) - $signed((Width + 1)'({mean, 1'b0}) * (Width + 1)'(weight));
  assign up = error < 0;
  assign tie = error == $signed((Width + 1)'(weight)) | -error == $signed((Width + 1)'(weight));
  assign near = (error < $signed((Width + 1)'(weight)) & -error < $signed((Width + 1)'(weight))) | (tie & ~mean[0]);

endmodule

`default_nettype wire
