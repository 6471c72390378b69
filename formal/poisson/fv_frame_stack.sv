// SPDX-License-Identifier: Apache-2.0
// fv_frame_stack: an arbitrary word leaves at its place of its row, last row first, unchanged; the last row 3 enabled
// clocks behind its own first word, the others behind it without a pause; frame_start with the first. Any gaps between
// bursts, any en, any frame number, and frames that begin before the last one is whole.

module fv_frame_stack #(
  parameter int Width       = 1,
  parameter int Rows        = 3,
  parameter int Size        = 4,
  parameter int WordsPerRow = 1,
  localparam int PositionWidth = $clog2(Size),
  localparam int RowWidth = $clog2(Rows + 1),
  localparam int PlaceWidth = $clog2(Rows * Size)
) (
  input logic             clk,
  input logic             rst,
  input logic             en,
  input logic             go,
  input logic             restart,
  input logic [Width-1:0] in_data,
  input logic             pick
);

  logic started = 1'b0;
  always_comb if (!started) assume (rst);
  always_ff @(posedge clk) started <= 1'b1;

  logic in_start, in_frame_start, active, last_row;
  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row;
  burst_source #(.Size(Size), .Rows(Rows)) u_source (
    .clk, .rst, .en, .go, .restart, .start(in_start), .frame_start(in_frame_start), .active, .position, .row, .last_row
  );

  logic out_start, out_frame_start;
  logic [Width-1:0] out_data;
  frame_stack #(.Width(Width), .Rows(Rows), .Size(Size), .WordsPerRow(WordsPerRow)) dut (
    .clk, .rst, .en, .in_start, .in_frame_start, .in_data, .out_start, .out_frame_start, .out_data
  );

  logic due, present, watched;
  logic [PlaceWidth-1:0] place;
  logic [Width-1:0] value;
  follow_word #(.Width(Width), .Words(Rows * Size), .Latency(3)) u_follow (
    .clk, .rst, .en, .pick, .in_word(active), .in_first(in_frame_start), .in_closed(last_row & ~in_start),
    .in_place(PlaceWidth'((Rows - 1 - 32'(row)) * Size + 32'(position))), .in_data, .close(in_start & last_row),
    .due, .present, .place, .watched, .value
  );
  logic held;
  logic [Width-1:0] out_data_q;
  always_ff @(posedge clk) begin
    held <= ~en;
    out_data_q <= out_data;
  end

  always_comb begin
    if (started) begin
      frame_when_due: assert (out_frame_start == due);
      row_when_due: assert (out_start == (present && place % PlaceWidth'(Size) == '0));
      if (watched) in_place: assert (out_data == value);
      if (held) holds: assert (out_data == out_data_q);
      last_word: cover (watched && place == PlaceWidth'(Rows * Size - 1));
      last_word_behind_next: cover (watched && place == PlaceWidth'(Rows * Size - 1) && active && held);
    end
  end

  bind fv_frame_stack.dut.u_ram ram_check #(.Depth(Depth)) u_check (
    .clk, .write_en, .write_address, .read_en, .read_address
  );

endmodule
