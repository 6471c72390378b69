// SPDX-License-Identifier: Apache-2.0
// fv_raster_check: a pixel is called wrong if, and only if, its position is not that of the pixel behind the last one in
// raster order; behind a start of a frame, due or not, the second pixel of a frame is due.

parameter int Rows = 4, Columns = 8;
localparam int Pixels = Rows * Columns;

logic [31:0] due, row, column;  // the pixel that is due, in raster order
assign row = due / Columns;
assign column = due % Columns;
wire taken = en & in_valid;
wire starts = in_position.first_row & in_position.first_column;
logic differs;
always_ff @(posedge clk) begin
  differs <= taken & (in_position.first_row != (row == 0) | in_position.last_row != (row == Rows - 1)
      | in_position.first_column != (column == 0) | in_position.last_column != (column == Columns - 1));
  if (taken) due <= starts ? 1 : due == Pixels - 1 ? 0 : due + 1;
  if (rst) begin
    due <= 0;
    differs <= 1'b0;
  end
end

always_comb begin
  if (started) begin
    told: assert (wrong == differs);
    counts: assert (due < Pixels && 32'(dut.row_due) == row && 32'(dut.column_due) == column);
    frame_ends: cover (due == Pixels - 1 && taken && !wrong);
    start_inside: cover (wrong && due == 1);
  end
end
