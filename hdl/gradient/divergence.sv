// SPDX-License-Identifier: Apache-2.0
// divergence: backward differences of the gradient, exact (no bit dropped).
//
//   f[i,j] = gx[i,j] - gx[i,j-1] + gy[i,j] - gy[i-1,j],  gx[i,-1] = gy[-1,j] = 0
//
// A gradient belongs to its pixel's centre, so this places the depth half a pixel up and left.
// Stream in: pixels in raster order, gaps anywhere, their place in the frame with them. Stream out: the same
// pixels. Latency: 2 cycles; one line of gy is stored. Bit-accurate model: models/tactile_depth/gradient/divergence.py.

module divergence #(
  parameter int Width   = 21,   // of a slope
  parameter int Columns = 128,
  parameter int Neumann = 0,  // 1: gx of the last column and gy of the last row count as 0
  localparam int OutWidth = Width + 2
) (
  input  logic                       clk,
  input  logic                       rst,
  input  logic                       en,
  input  logic                       in_valid,
  input  logic                       in_first_row,
  input  logic                       in_first_column,
  input  logic                       in_last_row,
  input  logic                       in_last_column,
  input  logic signed [Width-1:0]    in_gx,
  input  logic signed [Width-1:0]    in_gy,
  output logic                       out_valid,
  output logic                       out_frame_start,  // the first pixel of a frame
  output logic signed [OutWidth-1:0] out_data
);

  localparam int ColumnWidth = $clog2(Columns);

  logic [ColumnWidth-1:0] column, column_next, column_q;
  assign column = in_first_column ? '0 : column_next;

  logic valid_q, first_row_q, first_column_q;
  logic signed [Width-1:0] gx_q, gy_q, left, above, above_stored, left_stored;

  // Read while the pixel is taken, written one cycle later, so never the same place at once.
  ram #(
    .Width(Width),
    .Depth(Columns),
    .Style((Width * Columns > 4096) ? 1 : 0)
  ) u_line (
    .clk,
    .write_en     (en & valid_q),
    .write_address(column_q),
    .write_data   (gy_q),
    .read_en      (en & in_valid),
    .read_address (column),
    .read_data    (above_stored)
  );
  assign above = first_row_q ? '0 : above_stored;
  assign left = first_column_q ? '0 : left_stored;

  always_ff @(posedge clk) begin
    if (en) begin
      if (in_valid) begin
        gx_q <= Neumann != 0 && in_last_column ? '0 : in_gx;
        gy_q <= Neumann != 0 && in_last_row ? '0 : in_gy;
        column_q <= column;
        column_next <= column + ColumnWidth'(1);
        first_row_q <= in_first_row;
        first_column_q <= in_first_column;
      end
      if (valid_q) left_stored <= gx_q;
      valid_q <= in_valid;
      out_valid <= valid_q;
      out_frame_start <= valid_q & first_row_q & first_column_q;
      out_data <= (OutWidth'(gx_q) - OutWidth'(left)) + (OutWidth'(gy_q) - OutWidth'(above));
    end
    if (rst) begin
      valid_q <= 1'b0;
      out_valid <= 1'b0;
      out_frame_start <= 1'b0;
    end
  end

`ifndef SYNTHESIS
  initial if (Columns < 2) $fatal(1, "%m: Columns must be at least 2");
`endif

endmodule
