// SPDX-License-Identifier: Apache-2.0
// fv_spectral_divide: word t of burst p meets the ROM word of the pair (p, t), whichever is larger, and leaves 4
// enabled clocks later; start and frame_start likewise; p counts from the frame's start. The data are 1, so that what
// leaves is M 2^S of the ROM word; square.hex says which, for every p and t. Rounding is proven of td_round_saturate.

parameter int Columns = 4;
localparam int Width = 10, CoeffWidth = 8, ShiftWidth = 1, Drop = 0;
input logic pick;

localparam int PositionWidth = $clog2(Columns), RowWidth = $clog2(Columns + 1), Latency = 4;

assign in_data = Width'(1);
logic started, active;
logic [PositionWidth-1:0] position;  // of the mode that comes in 2 enabled clocks
logic [RowWidth-1:0] row;

logic [Width-1:0] square[Columns*Columns];
initial $readmemh("square.hex", square);

logic due, held, whole = 1'b0;  // whole: the last word of a frame has left
logic [Width-1:0] expected;
follow_delay #(.Width(Width), .Latency(Latency + 2)) u_follow (
  .clk, .rst, .en, .pick(pick & active), .in(square[{row[PositionWidth-1:0], position}]), .due, .word(expected)
);
kept #(.Width(Width + 2)) u_kept (.clk, .rst, .en, .out({out_start, out_frame_start, out_data}), .held);
burst_timing #(.Columns(Columns), .Rows(Columns), .Latency(Latency)) u_timing (.*);
always_ff @(posedge clk) if (en && due && expected == square[Columns*Columns-1]) whole <= 1'b1;
always_comb begin
  if (started) begin
    if (due) own_reciprocal: assert (out_data == $signed(expected));
    none_clipped: assert (!saturations);
    other_burst: cover (due && expected == square[Columns+1] && held);
    if (Columns <= 4) begin  // as far as a trace of a whole frame is quick to find
      second_frame: cover (due && whole && expected == square[0] && held);
    end
  end
end
