// SPDX-License-Identifier: Apache-2.0
// fv_spectral_divide: word t of burst p meets the ROM word of the pair (p, t), whichever is larger, and leaves 6
// enabled clocks later; start and frame_start likewise; p counts from the frame's start. The data are 1, so that what
// leaves is M 2^S of the ROM word; square.hex says which, for every p and t. Rounding is proven of td_round_saturate.

`default_nettype none

module fv_spectral_divide #(
  parameter int Columns = 4,
  localparam int PositionWidth = $clog2(Columns),
  localparam int RowWidth = $clog2(Columns + 1)
) (
  input logic clk,
  input logic rst,
  input logic en,
  input logic go,
  input logic restart,
  input logic pick
);

  localparam int Latency = 6;
  localparam int Width = 10;

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  logic in_start, in_frame_start, active, last_row;
  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row;
  burst_source #(.Columns(Columns), .Rows(Columns)) u_source (
    .clk, .rst, .en, .go, .restart, .start(in_start), .frame_start(in_frame_start), .active, .position, .row, .last_row
  );

  logic out_start, out_frame_start, saturations;
  logic signed [Width-1:0] out_data;
  spectral_divide #(
    .Width(Width), .CoeffWidth(8), .Columns(Columns), .ShiftWidth(1), .Drop(0)
  ) dut (
    .clk, .rst, .en, .in_start, .in_frame_start, .in_data(Width'(1)),
    .out_start, .out_frame_start, .out_data, .saturations
  );

  logic [Width-1:0] square[Columns*Columns];
  initial $readmemh("square.hex", square);

  logic following, held;
  logic [2:0] age;
  logic [Width-1:0] expected;
  logic [Width+1:0] out_q;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    held <= ~en & ~rst;
    out_q <= {out_start, out_frame_start, out_data};
    if (en) begin
      if (!following || age == 3'(Latency)) begin
        following <= pick & active;
        age <= 3'd1;
        expected <= square[{row[PositionWidth-1:0], position}];
      end else begin
        age <= age + 3'd1;
      end
    end
    if (rst) following <= 1'b0;
  end

  burst_timing #(.Columns(Columns), .Latency(Latency)) u_timing (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .out_frame_start
  );
  always_comb begin
    if (started) begin
      if (following && age == 3'(Latency)) own_reciprocal: assert (out_data == $signed(expected));
      if (held) holds: assert ({out_start, out_frame_start, out_data} == out_q);
      none_clipped: assert (!saturations);
      other_burst: cover (following && age == 3'(Latency) && expected == square[Columns+1] && held);
      if (Columns <= 4) begin  // as far as a trace of a whole frame is quick to find
        last_of_frame: cover (following && age == 3'(Latency) && expected == square[Columns*Columns-1]);
        second_frame: cover (following && age == 3'(Latency) && out_frame_start && expected == square[0] && held);
      end
    end
  end

endmodule

`default_nettype wire
