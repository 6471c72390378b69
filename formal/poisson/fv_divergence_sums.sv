// SPDX-License-Identifier: Apache-2.0
// fv_divergence_sums: four sums leave for each row, the first ScaleFraction + 4 enabled clocks behind its last word, one
// in ScaleFraction + 1; out_frame_start comes with the first of a frame. Frames that are cut short, any gaps, any en.

parameter int LastFirst = 1;
localparam int Columns = 32, Width = 3, Dropped = 1, Scale = 1, ScaleFraction = 1, SumWidth = 4;
localparam int Apart = ScaleFraction + 1, First = ScaleFraction + 4, Last = First + 3 * Apart;

logic [5:0] column;  // of the word that comes next; a frame begins at any word
logic first_row, begun;
logic [Last-1:0] ended, began;  // [n]: the last word of a row, of the first row of a frame, came n + 1 clocks ago
wire takes = en & in_valid;
wire row_ends = takes & ~in_frame_start & (32'(column) == Columns - 1);
always_ff @(posedge clk) begin
  if (takes) column <= in_frame_start ? 6'd1 : row_ends ? '0 : column + 6'd1;
  if (takes && in_frame_start) first_row <= 1'b1;
  else if (row_ends) first_row <= 1'b0;
  if (en) begin
    ended <= Last'({ended, row_ends});
    began <= Last'({began, row_ends & first_row});
  end
  if (takes) begun <= 1'b1;
  if (rst) {column, first_row, begun, ended, began} <= '0;
end
always_comb assume ((!in_frame_start || in_valid) && (!takes || in_frame_start || begun));

always_comb begin
  if (started) begin
    in_time: assert (out_valid == (ended[First-1] | ended[First+Apart-1] | ended[First+2*Apart-1] | ended[Last-1]));
    of_frame: assert ((out_valid & out_frame_start) == began[First-1]);
    last_of_four: cover (out_valid && ended[Last-1]);
    frames: cover (out_frame_start && column != '0);
  end
end
