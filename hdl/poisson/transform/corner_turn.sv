// SPDX-License-Identifier: Apache-2.0
// corner_turn: two rows that come together leave one behind the other, Lanes neighbouring words of a row a cycle.
//
// Stream in: bursts of Beats = Size / Paths beats, Paths = Lanes / 2, or 1; path l has in beat t the words of rows a
// and b at position l Beats + t in Makhoul order (0, 2, 4, .., 5, 3, 1); starts come 2 cycles before the first beat.
// in_alone: row b does not count. Stream out: row a, then row b (in_alone: not), each a burst of Size / Lanes beats of
// Lanes words in natural order, the first word in the lowest bits; starts come with the first beat. Bursts come no
// faster than their rows leave.
// Latency: Beats + 4 cycles from in_start to row a; bursts may have pauses between them; en low: nothing moves.
//
// Even words of a row are the first half of its positions, odd words are the second half from its end. With one path
// each half has a memory for each row. With more it has one for each of its words in a beat, 2 rows x Paths / 2.
// Word w of these at beat t (counted from the end in the second half) is in memory w ^ t, or w ^ (Paths / Beats) t
// if there are fewer beats than paths. So the Paths words of one row that leave in a cycle are in Paths memories.
// Two bursts of memory, written and read in turn.
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/corner_turn.py.

`default_nettype none

module corner_turn #(
  parameter int Width  = 24,
  parameter int Size   = 128,  // a power of two
  parameter int Lanes  = 8,  // a power of two up to Size / 2
  parameter int Parity = 0,  // 1: a parity bit in each word of a memory
  localparam int Paths = Lanes > 1 ? Lanes / 2 : 1
) (
  input  wire                      clk,
  input  wire                      rst,
  input  wire                      en,
  input  wire                      in_start,
  input  wire                      in_frame_start,   // with in_start: the first burst of a frame
  input  wire                      in_alone,         // with in_start
  input  wire  [Paths*Width-1:0]   in_a,             // words of any format, unchanged in out_data
  input  wire  [Paths*Width-1:0]   in_b,
  output logic                     out_start,
  output logic                     out_frame_start,  // the first row of a frame
  output logic [Lanes*Width-1:0]   out_data,
  output logic                     flipped  // a word that was read has a flipped bit
);

  localparam int Beats = Size / Paths;
  localparam int BeatWidth = $clog2(Beats);
  localparam int Reads = 2 * Size / Lanes;  // of two rows
  localparam int ReadWidth = $clog2(Reads);
  localparam int PathWidth = $clog2(Paths);
  // One word a cycle: the first is none of the last beat's, so it is read as that one is written. The cycle saved goes
  // to a register behind the memories, which are slow.
  localparam int Ahead = Lanes == 1 ? 1 : 0;

  // Writer: beat of the words present, and the bank of their burst.
  logic [BeatWidth-1:0] position, position_q, beat;
  logic active, write_bank, write_bank_q, frame_start_q, alone_q;
  logic [1:0] active_q, last_q;
  td_burst_counter #(.Words(Beats)) u_write (
    .clk, .rst, .en, .start(in_start), .position, .active
  );

  // Reader: one burst later.
  logic next_frame_start, next_alone, read_start, read_active, read_bank, read_frame_start, read_alone, row_start;
  logic [ReadWidth-1:0] read_beat;
  logic row;  // 0: a, 1: b
  td_burst_counter #(.Words(Reads)) u_read (
    .clk, .rst, .en, .start(read_start), .position(read_beat), .active(read_active)
  );
  assign row = read_beat[ReadWidth-1];
  assign row_start = read_active & (read_beat[ReadWidth-2:0] == '0) & ~(row & read_alone);

  logic [1:0][Paths*Width-1:0] read;  // in each half the words that leave
  logic [1:0][(Paths > 1 ? Paths : 2)-1:0] flips;
  if (Paths == 1) begin : g_single
    logic [1+Ahead:1] row_q;
    logic [3:0] b_read;  // of rows that are all alone, b is never read, and what its memories show is unknown
    assign flipped = flips[0][0] | flips[1][0] | (b_read[3] & (flips[0][1] | flips[1][1]));
    always_ff @(posedge clk) begin
      if (en) row_q <= (1 + Ahead)'({row_q, row});
      if (en) b_read <= {b_read[2:0], b_read[0] | (read_active & row)};
      if (rst) b_read <= '0;
    end
    for (genvar half = 0; half < 2; half++) begin : g_half
      logic [1:0][Width-1:0] words;
      for (genvar r = 0; r < 2; r++) begin : g_row
        td_parity_ram #(.Width(Width), .Depth(Beats), .Latency(1 + Ahead), .Parity(Parity)) u_ram (
          .clk, .en,
          .write_en     (en & active_q[1] & (beat[BeatWidth-1] == 1'(half))),
          .write_address({write_bank_q, beat[BeatWidth-2:0] ^ {(BeatWidth - 1){1'(half)}}}),
          .write_data   (r == 0 ? in_a : in_b),
          .read_en      (en & read_active & (row == 1'(r)) & (Ahead == 0 | read_beat[0] == 1'(half))),
          .read_address ({read_bank, read_beat[ReadWidth-2-:BeatWidth-1]}),
          .read_data    (words[r]),
          .flipped      (flips[half][r])
        );
      end
      assign read[half] = words[row_q[1+Ahead]];
    end
  end else begin : g_paths
    assign flipped = flips != '0;
    localparam int Turned = BeatWidth < PathWidth ? BeatWidth : PathWidth;  // bits of the beat in a memory's number
    localparam int Fixed = PathWidth - Turned;

    // Word w of the result is word w ^ amount.
    function automatic logic [Paths*Width-1:0] exchanged(
      input logic [Paths*Width-1:0] words, input logic [PathWidth-1:0] amount
    );
      logic [Paths*Width-1:0] current;
      exchanged = words;
      for (int level = 0; level < PathWidth; level++) begin
        current = exchanged;
        for (int w = 0; w < Paths; w++) begin
          if (amount[level]) exchanged[w*Width+:Width] = current[(w^(1<<level))*Width+:Width];
        end
      end
    endfunction

    // First position of the words that leave, with their row on top: path number, then beat.
    logic [BeatWidth+PathWidth-1:0] place;
    logic [PathWidth-1:0] turn, turn_q;
    assign place = {read_beat, PathWidth'(0)};
    assign turn = place[BeatWidth+:PathWidth];
    always_ff @(posedge clk) if (en) turn_q <= turn;

    for (genvar half = 0; half < 2; half++) begin : g_half
      logic [BeatWidth-1:0] write_beat;
      logic [PathWidth-1:0] write_turn;
      logic [Paths*Width-1:0] in_words, write_words, memory, turned;
      assign write_beat = beat ^ {BeatWidth{1'(half)}};
      assign write_turn = PathWidth'(write_beat[Turned-1:0]) << Fixed;
      assign write_words = exchanged(in_words, write_turn);
      assign turned = exchanged(memory, turn_q);
      for (genvar w = 0; w < Paths; w++) begin : g_memory
        localparam int InHalf = w % (Paths / 2);  // path, counted from the end in the second half
        localparam int Path = half == 0 ? InHalf : Paths - 1 - InHalf;
        localparam int Source = (w >> Turned) | ((w % (1 << Turned)) << Fixed);  // of word w that leaves
        logic [Turned-1:0] low;
        assign in_words[w*Width+:Width] = w < Paths / 2 ? in_a[Path*Width+:Width] : in_b[Path*Width+:Width];
        assign low = turn[PathWidth-1:Fixed] ^ Turned'($unsigned(w >> Fixed));
        td_parity_ram #(.Width(Width), .Depth(2 * Beats), .Parity(Parity)) u_ram (
          .clk, .en,
          .write_en     (en & active_q[1]),
          .write_address({write_bank_q, write_beat}),
          .write_data   (write_words[w*Width+:Width]),
          .read_en      (en & read_active),
          .read_address ({read_bank, place[BeatWidth-1:0] | BeatWidth'(low)}),
          .read_data    (memory[w*Width+:Width]),
          .flipped      (flips[half][w])
        );
        assign read[half][w*Width+:Width] = turned[Source*Width+:Width];
      end
    end
  end

  logic [Lanes*Width-1:0] leaves;
  if (Lanes == 1) begin : g_one_lane
    logic [1:0] odd_q;
    always_ff @(posedge clk) if (en) odd_q <= {odd_q[0], read_beat[0]};
    assign leaves = read[odd_q[1]];
  end else begin : g_lanes
    for (genvar w = 0; w < Paths; w++) begin : g_pair
      assign leaves[2*w*Width+:2*Width] = {read[1][w*Width+:Width], read[0][w*Width+:Width]};
    end
  end

  logic [1+Ahead:0] row_start_q, frame_row_q;
  assign out_start = row_start_q[1+Ahead];
  assign out_frame_start = frame_row_q[1+Ahead];
  always_ff @(posedge clk) begin
    if (en) begin
      position_q <= position;
      beat <= position_q;
      active_q <= {active_q[0], active};
      last_q <= {last_q[0], active & (position == BeatWidth'(Beats - 1))};
      if (in_start) begin
        write_bank <= ~write_bank;
        frame_start_q <= in_frame_start;
        alone_q <= in_alone;
      end
      write_bank_q <= write_bank;
      if (Ahead == 0 && last_q[0]) {next_frame_start, next_alone} <= {frame_start_q, alone_q};
      if (last_q[1-Ahead]) begin
        {read_frame_start, read_alone, read_bank} <=
            Ahead == 0 ? {next_frame_start, next_alone, write_bank_q} : {frame_start_q, alone_q, write_bank};
      end
      read_start <= last_q[1-Ahead];
      row_start_q <= {row_start_q[Ahead:0], row_start};
      frame_row_q <= {frame_row_q[Ahead:0], row_start & ~row & read_frame_start};
      out_data <= leaves;
    end
    if (rst) {active_q, last_q, write_bank, read_start, row_start_q, frame_row_q} <= '0;
  end

endmodule

`default_nettype wire
