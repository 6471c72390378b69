// SPDX-License-Identifier: Apache-2.0
// wide_row_pairs: modes of two rows a, b become the words of one complex inverse transform.
//
//   out[p] = sat(a[N-k] - b[k]) + j sat(a[k] + b[N-k]),  k = p with its bits reversed, a[N] = b[N] = 0, N = Size
//
// Stream in: bursts of 2 Beats beats, 2 Paths words each, word 0 in the lowest bits, Beats = Size / (2 Paths): row a,
// then row b. Word s Paths + l of beat u of a row is at position p = t Paths + l in bit-reversed order, where t = 2 u
// for s = 0 and t = 2 mirror(u) + 1 for s = 1; mirror(u) inverts all bits below the leading one. So k and N - k are in
// one beat. in_alone: row a alone, b counts as 0. Stream out: bursts of 2 Beats beats, Paths complex words each, path l
// of beat t at p = t Paths + l. Starts of both come 2 cycles before the first beat.
// Latency: Beats + 2 cycles; bursts may have pauses between them; en low: nothing moves.
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/wide_row_pairs.py.

`default_nettype none

module wide_row_pairs #(
  parameter int Width = 27,
  parameter int Size  = 128,  // a power of two
  parameter int Paths = 4,  // a power of two up to Size / 4
  localparam int CountWidth = $clog2(4 * Paths + 1)
) (
  input  wire                      clk,
  input  wire                      rst,
  input  wire                      en,
  input  wire                      in_start,
  input  wire                      in_frame_start,  // with in_start: the first burst of a frame
  input  wire                      in_alone,        // with in_start
  input  wire  [2*Paths*Width-1:0] in_data,         // F fraction bits, as out_re and out_im
  output logic                     out_start,
  output logic                     out_frame_start,
  output logic [Paths*Width-1:0]   out_re,
  output logic [Paths*Width-1:0]   out_im,
  output logic [CountWidth-1:0]    saturations      // clip count, delayed
);

  localparam int PathWidth = Paths > 1 ? $clog2(Paths) : 1;
  localparam int Beats = Size / (2 * Paths);  // of a row
  localparam int BeatWidth = $clog2(Beats);

  // Path of mode N - k in the first beat, where path 0 has mode 0 alone.
  function automatic int mirror(input int path);
    mirror = 0;
    for (int b = PathWidth - 1; b >= 0; b--) begin
      if (mirror == 0 && path / (1 << b) % 2 != 0) mirror = 3 * (1 << b) - 1 - path;
    end
  endfunction

  logic [BeatWidth:0] position;
  logic active, b_start, b_active, frame_start_q, alone_next, alone;
  td_burst_counter #(.Words(2 * Beats)) u_write (
    .clk, .rst, .en, .start(in_start), .position, .active
  );
  assign b_active = active & position[BeatWidth];
  assign b_start = active & (position == (BeatWidth + 1)'(Beats));

  // Row a waits for row b.
  logic [2*Paths*Width-1:0] late_a;
  for (genvar word = 0; word < 2 * Paths; word++) begin : g_late
    td_delay_line #(.Width(Width), .Delay(Beats)) u_late (
      .clk, .rst, .en, .in(in_data[word*Width+:Width]), .out(late_a[word*Width+:Width])
    );
  end

  // Sums, exact, then saturated into memory: the beats of s = 0 and those of s = 1 have one each.
  logic [2:0] b_start_q, b_active_q;
  logic [1:0] b_frame_start_q;
  logic [2:0][BeatWidth-1:0] beat_q;
  logic first;  // beat 0 of row b is present
  assign first = b_start_q[1];

  logic read_active, read_start;
  logic [BeatWidth:0] read_position;
  logic [BeatWidth-1:0] read_beat, mirrored_beat;
  td_burst_counter #(.Words(2 * Beats)) u_read (
    .clk, .rst, .en, .start(read_start), .position(read_position), .active(read_active)
  );
  assign read_start = b_start_q[2];
  assign read_beat = read_position[BeatWidth:1];
  for (genvar i = 0; i < BeatWidth; i++) begin : g_mirror
    if (i == BeatWidth - 1) begin : g_top
      assign mirrored_beat[i] = read_beat[i];
    end else begin : g_below
      assign mirrored_beat[i] = read_beat[i] ^ (|read_beat[BeatWidth-1:i+1]);
    end
  end

  logic [1:0] read_from;  // the word that leaves: 0, 1: from the memory of s; 2: the first one, from no memory
  logic [4*Paths-1:0] clipped, clipped_q;
  for (genvar l = 0; l < Paths; l++) begin : g_path
    logic [1:0][2*Width-1:0] memory;
    logic [2*Width-1:0] saturated_0, first_word;
    for (genvar s = 0; s < 2; s++) begin : g_half
      localparam int Word = s * Paths + l;
      localparam int Mirrored = (1 - s) * Paths + Paths - 1 - l;
      localparam int FirstMirrored = s == 0 ? mirror(l) : 2 * Paths - 1 - l;
      localparam int None = s == 0 && l == 0 ? 1 : 0;  // mode 0 has no partner in the first beat
      logic signed [Width-1:0] b, b_mirrored, a, a_mirrored;
      logic signed [Width:0] sum_re, sum_im;
      logic signed [Width-1:0] re, im;
      assign a = late_a[Word*Width+:Width];
      assign a_mirrored = !first ? late_a[Mirrored*Width+:Width] : None != 0 ? '0 : late_a[FirstMirrored*Width+:Width];
      assign b = alone ? '0 : in_data[Word*Width+:Width];
      assign b_mirrored = alone || (first && None != 0) ? '0 :
          first ? in_data[FirstMirrored*Width+:Width] : in_data[Mirrored*Width+:Width];
      always_ff @(posedge clk) begin
        if (en) begin
          sum_re <= (Width + 1)'(a_mirrored) - (Width + 1)'(b);
          sum_im <= (Width + 1)'(a) + (Width + 1)'(b_mirrored);
        end
      end
      td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_re (
        .in(sum_re), .out(re), .clipped(clipped[2*Word])
      );
      td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_im (
        .in(sum_im), .out(im), .clipped(clipped[2*Word+1])
      );
      td_ram #(.Width(2 * Width), .Depth(Beats)) u_ram (
        .clk,
        .write_en     (en & b_active_q[2]),
        .write_address(beat_q[2]),
        .write_data   ({re, im}),
        .read_en      (en & read_active & ~read_start & (read_position[0] == 1'(s))),
        .read_address (s == 0 ? read_beat : mirrored_beat),
        .read_data    (memory[s])
      );
      if (s == 0) begin : g_first
        assign saturated_0 = {re, im};
      end
    end
    always_ff @(posedge clk) if (en) first_word <= saturated_0;
    assign {out_re[l*Width+:Width], out_im[l*Width+:Width]} = read_from[1] ? first_word : memory[read_from[0]];
  end

  logic [CountWidth-1:0] count;
  always_comb begin
    count = '0;
    for (int i = 0; i < 4 * Paths; i++) count = count + CountWidth'(clipped_q[i]);
  end
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_start) begin
        frame_start_q <= in_frame_start;
        alone_next <= in_alone;
      end
      if (b_start_q[0]) alone <= alone_next;
      beat_q <= {beat_q[1:0], position[BeatWidth-1:0]};
      b_active_q <= {b_active_q[1:0], b_active};
      b_start_q <= {b_start_q[1:0], b_start};
      b_frame_start_q <= {b_frame_start_q[0], b_start & frame_start_q};
      read_from <= {read_start, read_position[0]};
    end
    clipped_q <= clipped & {4 * Paths{en & b_active_q[2]}};
    saturations <= count;
    if (rst) {b_active_q, b_start_q, b_frame_start_q, clipped_q, saturations} <= '0;
  end
  assign out_start = b_start_q[1];
  assign out_frame_start = b_frame_start_q[1];

endmodule

`default_nettype wire
