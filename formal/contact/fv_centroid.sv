// SPDX-License-Identifier: Apache-2.0
// fv_centroid: done exactly Latency clocks after the last start, with both means to the nearest, ties to even. Ties need an
// area of 32, which only the simulation has.

`default_nettype none

module fv_centroid #(
  parameter int PositionWidth = 2,
  parameter int AreaWidth     = 3,
  parameter int Latency       = 16,  // models/tactile_depth/contact/centroid.py
  localparam int SumWidth = AreaWidth + PositionWidth - 1,
  localparam int MeanWidth = PositionWidth + 4
) (
  input logic                 clk,
  input logic                 rst,
  input logic                 start,
  input logic [SumWidth-1:0]  column_sum,
  input logic [SumWidth-1:0]  row_sum,
  input logic [AreaWidth-1:0] area
);

  logic done;
  logic [MeanWidth-1:0] column, row;
  centroid #(.PositionWidth(PositionWidth), .AreaWidth(AreaWidth)) dut (.*);

  logic allowed, started;
  protocol_centroid #(.PositionWidth(PositionWidth), .AreaWidth(AreaWidth)) u_protocol (
    .clk, .rst, .start, .column_sum, .row_sum, .area, .done, .holds(allowed)
  );
  assumed u_assumed (.clk, .rst, .allowed, .started);

  logic [Latency-1:0] due;
  logic [SumWidth-1:0] columns, rows;
  logic [AreaWidth-1:0] count;
  logic column_near, row_near, column_up, unused_row_up;
  near_mean #(.SumWidth(SumWidth), .AreaWidth(AreaWidth), .MeanWidth(MeanWidth)) u_column (
    .sum(columns), .area(count), .mean(column), .near(column_near), .up(column_up)
  );
  near_mean #(.SumWidth(SumWidth), .AreaWidth(AreaWidth), .MeanWidth(MeanWidth)) u_row (
    .sum(rows), .area(count), .mean(row), .near(row_near), .up(unused_row_up)
  );
  always_ff @(posedge clk) begin
    due <= Latency'({due, start});
    if (start) begin
      due <= Latency'(1);
      {columns, rows, count} <= {column_sum, row_sum, area};
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

// near_mean: the mean is 16 sum / area, to the nearest, ties to even.
module near_mean #(
  parameter int SumWidth  = 4,
  parameter int AreaWidth = 3,
  parameter int MeanWidth = 6
) (
  input  logic [SumWidth-1:0]  sum,
  input  logic [AreaWidth-1:0] area,
  input  logic [MeanWidth-1:0] mean,
  output logic                 near,
  output logic                 up     // rounded up
);

  localparam int Width = MeanWidth + AreaWidth + 2;
  logic tie;
  logic signed [Width:0] error;  // twice the error, times the area
  assign error = $signed((Width + 1)'({sum, 5'd0})) - $signed((Width + 1)'({mean, 1'b0}) * (Width + 1)'(area));
  assign up = error < 0;
  assign tie = error == $signed((Width + 1)'(area)) | -error == $signed((Width + 1)'(area));
  assign near = (error < $signed((Width + 1)'(area)) & -error < $signed((Width + 1)'(area))) | (tie & ~mean[0]);

endmodule

`default_nettype wire
