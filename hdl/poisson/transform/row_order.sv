// SPDX-License-Identifier: Apache-2.0
// row_order: collects a row, then sends it as one burst, Paths words a cycle, in the order of dst_forward.
//
// Stream in: words with gaps anywhere; a row begins afresh at a frame's first word. Stream out: bursts of Beats =
// Columns / Paths beats, one a row, begun when the row is complete, path 0 in the lowest bits; starts come 2 cycles
// before the first beat. Path l has in beat t the word at position l Beats + t in Makhoul order (0, 2, 4, .., 5, 3, 1).
// Latency: out_start comes with the last word of a row. Two rows of memory, written and read in turn.
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/row_order.py.

`default_nettype none

module row_order #(
  parameter int Width   = 24,
  parameter int Columns = 128,  // a power of two
  parameter int Paths   = 4,  // a power of two up to Columns / 2
  parameter int Parity  = 0  // 1: a parity bit in each word of a memory
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    en,
  input  wire                    in_valid,
  input  wire                    in_frame_start,   // the first word of a frame
  input  wire  [Width-1:0]       in_data,          // a word of any format, unchanged in out_data
  output logic                   out_start,
  output logic                   out_frame_start,  // the first burst of a frame
  output logic [Paths*Width-1:0] out_data,
  output logic                   flipped           // a word that was read has a flipped bit
);

  localparam int PositionWidth = $clog2(Columns);
  localparam int Beats = Columns / Paths;
  localparam int BeatWidth = $clog2(Beats);

  logic write_bank, read_bank, read_start, read_active, frame_start, frame_start_q;
  logic [PositionWidth-1:0] position, position_q, makhoul;
  logic [BeatWidth-1:0] beat;
  td_burst_counter #(.Words(Beats)) u_read (
    .clk, .rst, .en, .start(read_start), .position(beat), .active(read_active)
  );
  assign position = in_frame_start ? '0 : position_q;
  assign makhoul = {position[0], position[PositionWidth-1:1] ^ {(PositionWidth - 1){position[0]}}};

  logic [Paths-1:0] flips;
  assign flipped = flips != '0;
  for (genvar path = 0; path < Paths; path++) begin : g_path
    wire own;  // the word present belongs to the path
    if (Paths == 1) begin : g_all
      assign own = 1'b1;
    end else begin : g_some
      assign own = (makhoul >> BeatWidth) == PositionWidth'(path);
    end
    td_parity_ram #(.Width(Width), .Depth(2 * Beats), .Parity(Parity)) u_ram (
      .clk, .en,
      .write_en     (en & in_valid & own),
      .write_address({write_bank, makhoul[BeatWidth-1:0]}),
      .write_data   (in_data),
      .read_en      (en & read_active),
      .read_address ({read_bank, beat}),
      .read_data    (out_data[path*Width+:Width]),
      .flipped      (flips[path])
    );
  end

  // The row that is being collected is a frame's first.
  assign frame_start = position == '0 ? in_frame_start : frame_start_q;
  assign out_start = in_valid & (position == PositionWidth'(Columns - 1));
  assign out_frame_start = out_start & frame_start;
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_valid) begin
        position_q <= position + PositionWidth'(1);
        frame_start_q <= frame_start;
      end
      if (out_start) begin
        write_bank <= ~write_bank;
        read_bank <= write_bank;
      end
      read_start <= out_start;
    end
    if (rst) {write_bank, read_bank, read_start} <= '0;
  end

endmodule

`default_nettype wire
