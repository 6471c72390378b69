// SPDX-License-Identifier: Apache-2.0
// fv_wide_stack: an arbitrary word of an arbitrary row leaves unchanged in its beat and at its place of it, last row
// first; the first words out Latency enabled clocks behind those of the last row, and no pause in a frame; starts,
// frame_start and alone 6 clocks before. Any gaps between bursts, any en, and frames that begin afresh.

`default_nettype none

module fv_wide_stack #(
  parameter int Width    = 1,
  parameter int Rows     = 3,
  parameter int Columns  = 16,
  parameter int InWords  = 2,
  parameter int OutWords = 4,
  localparam int InWidth = $clog2(InWords),
  localparam int OutWidth = $clog2(OutWords)
) (
  input logic                     clk,
  input logic                     rst,
  input logic                     en,
  input logic                     in_start,
  input logic                     in_frame_start,
  input logic [InWords*Width-1:0] in_last,
  input logic [InWords*Width-1:0] in_ahead,
  input logic                     pick,
  input logic                     of_last,  // the word followed is one of in_last
  input logic [InWidth-1:0]       chosen    // the word of a clock
);

  localparam int Clocks = Columns / InWords;
  localparam int Beats = Columns / OutWords;
  localparam int Pairs = (Rows + 1) / 2;
  localparam int Latency = Clocks - Beats / 2 + 2;
  localparam int ToStart = Latency + 2 - 6;  // clocks from the start of the last row to the first start
  localparam int Longest = ToStart + (Pairs - 1) * 2 * Beats;
  localparam int PositionWidth = $clog2(Clocks);
  localparam int RowWidth = $clog2(Rows + 1);
  localparam int BeatWidth = $clog2(Beats);
  localparam int PlaceWidth = $clog2(Rows * Beats);

  logic allowed, started, active, last_row;
  logic [PositionWidth-1:0] position;
  logic [RowWidth-1:0] row;
  logic out_start, out_frame_start, out_alone;
  logic [OutWords*Width-1:0] out_data;
  wide_stack #(.Width(Width), .Rows(Rows), .Columns(Columns), .InWords(InWords), .OutWords(OutWords)) dut (.*);
  protocol_wide_stack #(.Columns(Columns), .Rows(Rows), .InWords(InWords), .OutWords(OutWords)) u_protocol (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .last_row, .holds(allowed)
  );
  assumed u_assumed (.clk, .rst, .allowed, .started);

  // All of the input as late as the words are.
  logic [1:0] start_q, frame_start_q, active_q, last_q;
  logic [1:0][PositionWidth-1:0] position_q;
  logic [1:0][RowWidth-1:0] row_q;
  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= {start_q[0], in_start};
      frame_start_q <= {frame_start_q[0], in_frame_start};
      active_q <= {active_q[0], active};
      last_q <= {last_q[0], last_row};
      position_q <= {position_q[0], position};
      row_q <= {row_q[0], row};
    end
    if (rst) begin
      start_q <= '0;
      frame_start_q <= '0;
      active_q <= '0;
    end
  end

  // Where the word leaves: its block of OutWords / 2 positions gives the beat and the half of it.
  function automatic logic [BeatWidth-1:0] mirror(input logic [BeatWidth-1:0] beat);
    logic above;
    above = 1'b0;
    for (int b = BeatWidth - 1; b >= 0; b--) begin
      mirror[b] = beat[b] ^ above;
      above = above | beat[b];
    end
  endfunction
  logic [31:0] in_row, block;
  logic [BeatWidth-1:0] beat;
  logic [OutWidth-1:0] at, lane;
  logic [RowWidth-1:0] own_row;
  assign in_row = 32'(position_q[1]) * InWords + 32'(chosen);
  assign block = in_row / (OutWords / 2);
  assign beat = block[0] ? mirror(BeatWidth'(block >> 1)) : BeatWidth'(block >> 1);
  assign at = OutWidth'(32'(block[0]) * (OutWords / 2) + in_row % (OutWords / 2));
  assign own_row = of_last ? row_q[1] : row_q[1] - RowWidth'(1);

  logic due, present, watched, close, word;
  logic [PlaceWidth-1:0] place;
  logic [Width-1:0] in_word, value, out_word;
  assign close = start_q[1] & last_q[1];
  assign word = active_q[1] & (of_last ? last_q[1] : row_q[1] != '0);
  assign in_word = of_last ? in_last[chosen*Width+:Width] : in_ahead[chosen*Width+:Width];
  assign out_word = out_data[lane*Width+:Width];
  follow_word #(.Width(OutWidth + Width), .Words(Rows * Beats), .Latency(Latency)) u_follow (
    .clk, .rst, .en, .pick, .in_word(word), .in_first(frame_start_q[1]), .in_closed(last_q[1] & ~start_q[1]),
    .in_place(PlaceWidth'((Rows - 1 - 32'(own_row)) * Beats + 32'(beat))), .in_data({at, in_word}), .close,
    .due, .present, .place, .watched, .value({lane, value})
  );

  logic [Longest-1:0] closes;
  logic [Pairs-1:0] pairs;  // that begin
  for (genvar pair = 0; pair < Pairs; pair++) begin : g_pair
    assign pairs[pair] = closes[ToStart-1+pair*2*Beats];
  end
  always_ff @(posedge clk) begin
    if (en) closes <= Longest'({closes, in_start & last_row});
    if (rst) closes <= '0;
  end

  always_comb begin
    if (started) begin
      start_when_due: assert (out_start == (pairs != '0));
      frame_start_when_due: assert (out_frame_start == pairs[0]);
      if (out_start) alone_when_due: assert (out_alone == (Rows % 2 != 0 && pairs[Pairs-1]));
      if (watched) in_place: assert (out_word == value);
      last_word: cover (watched && place == PlaceWidth'(Rows * Beats - 1) && en);
      behind_next: cover (watched && active && en);
    end
  end

  bind td_ram ram_check #(.Depth(Depth), .Covered(0)) u_check (.*);

endmodule

`default_nettype wire
