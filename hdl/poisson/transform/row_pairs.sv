// SPDX-License-Identifier: Apache-2.0
// row_pairs: modes of two rows a, b become the words of one complex inverse transform.
//
//   out[p] = sat(a[N-k] - b[k]) + j sat(a[k] + b[N-k]),  k = p with its bits reversed, a[N] = b[N] = 0, N = Size
//
// Stream in: bursts of Beats = Size / Paths beats, Paths modes of each row a beat, path 0 in the lowest bits; path l
// has in beat t the mode at position p = t Paths + l in bit-reversed order. Stream out: the same bursts of complex
// words. Starts of both come 2 cycles before the first beat. Latency: Beats / 2 + 3 cycles; bursts may have pauses
// between them; en low: nothing moves.
//
// In bit-reversed order the modes of positions 2^m .. 2^(m+1) - 1 are the odd multiples of N / 2^(m+1): N - k stands in
// the same group, counted from its other end, so its position is that of k with every bit below the leading one
// inverted. The core waits for half a burst. A memory of one burst is enough, because each beat is read before that of
// the next burst comes. Bit-accurate model: models/tactile_depth/chip/poisson/transform/row_pairs.py.

`default_nettype none

module row_pairs #(
  parameter int Width  = 27,
  parameter int Size   = 128,  // a power of two
  parameter int Paths  = 4,  // a power of two up to Size / 4
  parameter int Parity = 0,  // 1: a parity bit in each word of a memory
  localparam int CountWidth = $clog2(2 * Paths + 1)
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    en,
  input  wire                    in_start,
  input  wire                    in_frame_start,  // with in_start: the first burst of a frame
  input  wire  [Paths*Width-1:0] in_a,            // F fraction bits, as in_b, out_re and out_im
  input  wire  [Paths*Width-1:0] in_b,
  output logic                   out_start,
  output logic                   out_frame_start,
  output logic [Paths*Width-1:0] out_re,
  output logic [Paths*Width-1:0] out_im,
  output logic [CountWidth-1:0]  saturations,     // clip count, delayed
  output logic                   flipped          // a word that was read has a flipped bit
);

  localparam int Beats = Size / Paths;
  localparam int BeatWidth = $clog2(Beats);

  // Path of mode N - k in the first beat, where path 0 has mode 0 alone.
  function automatic int mirror(input int path);
    mirror = 0;
    for (int b = $clog2(Paths); b >= 0; b--) begin
      if (mirror == 0 && path / (1 << b) % 2 != 0) mirror = 3 * (1 << b) - 1 - path;
    end
  endfunction

  // Writes follow their counter by 2 cycles, as the words do.
  logic [BeatWidth-1:0] position, read_position, mirrored_position;
  logic [1:0][BeatWidth-1:0] position_q;
  logic active, read_start, read_active, frame_start_q;
  logic [1:0] active_q;
  td_burst_counter #(.Words(Beats)) u_write (
    .clk, .rst, .en, .start(in_start), .position, .active
  );
  assign read_start = active_q[1] & (position_q[1] == BeatWidth'(Beats / 2));
  td_burst_counter #(.Words(Beats)) u_read (
    .clk, .rst, .en, .start(read_start), .position(read_position), .active(read_active)
  );
  for (genvar i = 0; i < BeatWidth; i++) begin : g_mirror
    if (i == BeatWidth - 1) begin : g_top
      assign mirrored_position[i] = read_position[i];
    end else begin : g_below
      assign mirrored_position[i] = read_position[i] ^ (|read_position[BeatWidth-1:i+1]);
    end
  end

  logic [2*Paths*Width-1:0] beat, mirrored;  // row a in the lower bits
  logic [2*Paths-1:0] beat_flipped, mirrored_flipped;
  assign flipped = {beat_flipped, mirrored_flipped} != '0;
  for (genvar word = 0; word < 2 * Paths; word++) begin : g_word
    logic [Width-1:0] in;
    assign in = word < Paths ? in_a[word%Paths*Width+:Width] : in_b[word%Paths*Width+:Width];
    td_delay_line #(.Width(Width), .Delay(Beats / 2 + 2), .Parity(Parity)) u_beat (
      .clk, .rst, .en, .in, .out(beat[word*Width+:Width]), .flipped(beat_flipped[word])
    );
    td_parity_ram #(.Width(Width), .Depth(Beats), .Parity(Parity)) u_mirrored (
      .clk, .en,
      .write_en     (en & active_q[1]),
      .write_address(position_q[1]),
      .write_data   (in),
      .read_en      (en & read_active),
      .read_address (mirrored_position),
      .read_data    (mirrored[word*Width+:Width]),
      .flipped      (mirrored_flipped[word])
    );
  end

  logic first;  // beat 0 has been read
  logic [1:0] read_active_q;
  logic [2*Paths-1:0] clipped, clipped_q;
  for (genvar l = 0; l < Paths; l++) begin : g_path
    localparam int First = mirror(l);
    localparam int Later = Paths - 1 - l;
    localparam bit None = l == 0;  // mode 0 has no partner
    logic signed [Width-1:0] a, b, a_mirrored, b_mirrored, re, im;
    logic signed [Width:0] sum_re, sum_im;
    assign a = beat[l*Width+:Width];
    assign b = beat[(Paths+l)*Width+:Width];
    assign sum_re = (Width + 1)'(a_mirrored) - (Width + 1)'(b);
    assign sum_im = (Width + 1)'(a) + (Width + 1)'(b_mirrored);
    td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_re (
      .in(sum_re), .out(re), .clipped(clipped[2*l])
    );
    td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_im (
      .in(sum_im), .out(im), .clipped(clipped[2*l+1])
    );
    always_ff @(posedge clk) begin
      if (en) begin
        a_mirrored <= !first ? mirrored[Later*Width+:Width] : None ? '0 : mirrored[First*Width+:Width];
        b_mirrored <= !first ? mirrored[(Paths+Later)*Width+:Width]
            : None ? '0 : mirrored[(Paths+First)*Width+:Width];
        out_re[l*Width+:Width] <= re;
        out_im[l*Width+:Width] <= im;
      end
    end
  end

  logic [CountWidth-1:0] count;
  always_comb begin
    count = '0;
    for (int i = 0; i < 2 * Paths; i++) count = count + CountWidth'(clipped_q[i]);
  end
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_start) frame_start_q <= in_frame_start;
      position_q <= {position_q[0], position};
      active_q <= {active_q[0], active};
      read_active_q <= {read_active_q[0], read_active};
      first <= read_start;
      out_start <= read_start;
      out_frame_start <= read_start & frame_start_q;
    end
    clipped_q <= clipped & {2 * Paths{en & read_active_q[1]}};
    saturations <= count;
    if (rst) {active_q, read_active_q, out_start, out_frame_start, clipped_q, saturations} <= '0;
  end

endmodule

`default_nettype wire
