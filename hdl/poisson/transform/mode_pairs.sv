// SPDX-License-Identifier: Apache-2.0
// mode_pairs: mode k and mode N - k side by side.
//
// Stream in: bursts of Size modes in bit-reversed order. Stream out: the same bursts, with the mirrored mode beside
// each (mode N is 0). Latency: Size / 2 + 2 cycles; en low: nothing moves.
//
// In bit-reversed order the modes of positions 2^m .. 2^(m+1) - 1 are the odd multiples of N / 2^(m+1): N - k stands in
// the same group, counted from its other end, so its position is that of k with every bit below the leading one
// inverted. The core waits for half a burst. A memory of one burst is enough, because each position is read before the
// next burst reaches it. Bit-accurate model: models/tactile_depth/chip/poisson/transform/mode_pairs.py.

`default_nettype none

module mode_pairs #(
  parameter int Width = 27,
  parameter int Size  = 128
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire                     in_start,
  input  wire                     in_frame_start,  // with in_start: the first burst of a frame
  input  wire  signed [Width-1:0] in_mode,         // F fraction bits, as both words out
  output logic                    out_start,
  output logic                    out_frame_start,
  output logic signed [Width-1:0] out_mode,
  output logic signed [Width-1:0] out_mirrored
);

  localparam int PositionWidth = $clog2(Size);

  logic [PositionWidth-1:0] write_position, read_position, mirrored_position;
  logic write_active, read_active, read_start;
  td_burst_counter #(.Words(Size)) u_write (
    .clk, .rst, .en, .start(in_start), .position(write_position), .active(write_active)
  );
  assign read_start = write_active & (write_position == PositionWidth'(Size / 2));
  td_burst_counter #(.Words(Size)) u_read (
    .clk, .rst, .en, .start(read_start), .position(read_position), .active(read_active)
  );

  assign mirrored_position[PositionWidth-1] = read_position[PositionWidth-1];
  for (genvar b = 0; b < PositionWidth - 1; b++) begin : g_mirror
    assign mirrored_position[b] = read_position[b] ^ (|read_position[PositionWidth-1:b+1]);
  end

  // Writes and reads both follow their counters by a cycle: no word is read while it is written.
  logic signed [Width-1:0] mode_q;
  logic write_active_q, read_active_q, read_start_q, read_frame_start;
  logic [PositionWidth-1:0] write_position_q, mirrored_position_q;
  td_delay_line #(.Width(Width), .Delay(Size / 2 + 1)) u_delay (
    .clk, .rst, .en, .in(mode_q), .out(out_mode)
  );

  logic [Width-1:0] mirrored;
  td_ram #(.Width(Width), .Depth(Size), .Style(0)) u_ram (
    .clk,
    .write_en     (en & write_active_q),
    .write_address(write_position_q),
    .write_data   (mode_q),
    .read_en      (en & read_active_q),
    .read_address (mirrored_position_q),
    .read_data    (mirrored)
  );

  logic frame_start_q;  // of the burst that is being written
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_start) frame_start_q <= in_frame_start;
      mode_q <= in_mode;
      write_active_q <= write_active;
      write_position_q <= write_position;
      mirrored_position_q <= mirrored_position;
      read_active_q <= read_active;
      read_start_q <= read_start;
      read_frame_start <= read_start & frame_start_q;
      out_start <= read_start_q;
      out_frame_start <= read_frame_start;
    end
    if (rst) begin
      write_active_q <= 1'b0;
      read_active_q <= 1'b0;
      read_start_q <= 1'b0;
      read_frame_start <= 1'b0;
      out_start <= 1'b0;
      out_frame_start <= 1'b0;
    end
  end
  assign out_mirrored = out_start ? '0 : mirrored;

endmodule

`default_nettype wire
