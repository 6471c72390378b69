// SPDX-License-Identifier: Apache-2.0
// fv_corner_turn: an arbitrary word of an arbitrary lane leaves unchanged with its row, at its place; a row 3 enabled
// clocks behind its last word; frame_start with the first row of a frame. Any gaps between frames, any en.

`default_nettype none

module fv_corner_turn #(
  parameter int Width   = 1,
  parameter int Columns = 8,
  parameter int Lanes   = 4,
  parameter int Rows    = 2 * Lanes,  // as many as make all addresses occur
  localparam int PositionWidth = $clog2(Columns),
  localparam int LaneWidth = $clog2(Lanes),
  localparam int RowWidth = $clog2(Rows + 1)
) (
  input logic                   clk,
  input logic                   rst,
  input logic                   en,
  input logic [Lanes-1:0]       in_start,
  input logic                   in_frame_start,
  input logic [Lanes*Width-1:0] in_data,
  input logic                   pick,
  input logic [LaneWidth-1:0]   chosen
);

  localparam int Latency = 3;
  localparam int Longest = Latency + Columns - 1 + Columns / Lanes;
  localparam int LeftWidth = $clog2(Longest + 1);

  logic allowed, started;
  logic [Lanes-1:0] active;
  logic [Lanes*PositionWidth-1:0] position;
  logic [Lanes*RowWidth-1:0] row;
  lane_places #(.Columns(Columns), .Lanes(Lanes), .RowWidth(RowWidth)) u_places (
    .clk, .reset(rst), .en, .start(in_start), .frame_start(in_frame_start), .active, .position, .row
  );

  logic out_start, out_frame_start;
  logic [Lanes*Width-1:0] out_data;
  corner_turn #(.Width(Width), .Columns(Columns), .Lanes(Lanes)) dut (.*);

  protocol_corner_turn #(.Columns(Columns), .Lanes(Lanes)) u_protocol (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .holds(allowed)
  );
  assumed u_assumed (.clk, .rst, .allowed, .started);

  // The word that is present in the chosen lane, and where it shall leave: even samples are in the first half.
  logic [PositionWidth-1:0] place, sample;
  always_comb begin
    place = '0;
    for (int lane = 0; lane < Lanes; lane++) begin
      if (chosen == LaneWidth'(lane)) place = position[lane*PositionWidth+:PositionWidth];
    end
  end
  assign sample = 32'(place) < Columns / 2 ? place * 2 : PositionWidth'(2 * (Columns - 1 - 32'(place)) + 1);

  logic [Lanes-1:0] last_word, last_of_frame;
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    assign last_word[lane] = active[lane] && position[lane*PositionWidth+:PositionWidth] == PositionWidth'(Columns - 1);
    assign last_of_frame[lane] = last_word[lane] && row[lane*RowWidth+:RowWidth] == RowWidth'(Rows - 1);
  end

  logic following, watched, held;
  logic [LeftWidth-1:0] left;  // enabled clocks to the one in which the word shall stand at the output
  logic [LaneWidth-1:0] slot;
  logic [Width-1:0] value;
  logic [Latency-1:0] row_ends, first_row_ends, frame_ends;
  kept #(.Width(Lanes * Width)) u_kept (.clk, .rst(1'b0), .en, .out(out_data), .held);
  assign watched = following & (left == '0);
  always_ff @(posedge clk) begin
    if (en) begin
      row_ends <= Latency'({row_ends, |last_word});
      first_row_ends <= Latency'({first_row_ends, last_word[0] & (row[RowWidth-1:0] == '0)});
      frame_ends <= Latency'({frame_ends, |last_of_frame});
      if (!following) begin
        following <= pick & active[chosen];
        left <= LeftWidth'(Latency - 1 + Columns - 1 - 32'(place) + 32'(sample) / Lanes);
        slot <= LaneWidth'(32'(sample) % Lanes);
        value <= in_data[chosen*Width+:Width];
      end else begin
        following <= ~watched;
        left <= left - LeftWidth'(1);
      end
    end
    if (rst) begin
      row_ends <= '0;
      first_row_ends <= '0;
      frame_ends <= '0;
      following <= 1'b0;
    end
  end

  always_comb begin
    if (started) begin
      row_when_due: assert (out_start == row_ends[Latency-1]);
      frame_start_when_due: assert (out_frame_start == first_row_ends[Latency-1]);
      if (watched) in_place: assert (out_data[slot*Width+:Width] == value);
      last_row: cover (frame_ends[Latency-1] && watched && held);
      next_frame: cover (out_frame_start && watched && active[0]);
    end
  end

  bind td_ram ram_check #(.Depth(Depth)) u_check (.clk, .write_en, .write_address, .read_en, .read_address);

endmodule

`default_nettype wire
