// SPDX-License-Identifier: Apache-2.0
// row_reorder: collect a row, then send it as one burst in another order.
//
// Stream in: words with gaps anywhere; a row begins afresh at a frame's first word. Stream out: bursts of Columns
// words, one a row, begun when the row is complete, so what follows never sees a gap.
//   ToBurst = 1: natural order in, Makhoul order out (0, 2, 4, .., 5, 3, 1).  ToBurst = 0: the reverse.
// Latency: 2 cycles from the last word of a row to its first word out. Two rows of memory, written and read in turn.
// Bit-accurate model: models/tactile_depth/chip/poisson/transform/row_reorder.py.

`default_nettype none

module row_reorder #(
  parameter int Width   = 24,
  parameter int Columns = 128,
  parameter int ToBurst = 1
) (
  input  wire              clk,
  input  wire              rst,
  input  wire              en,
  input  wire              in_valid,
  input  wire              in_frame_start,   // the first word of a frame
  input  wire  [Width-1:0] in_data,          // a word of any format, unchanged in out_data
  output logic             out_start,
  output logic             out_frame_start,  // the first burst of a frame
  output logic [Width-1:0] out_data
);

  localparam int PositionWidth = $clog2(Columns);

  // Sample at position p of a burst: 2 p in the first half, counted back from Columns - 1 in the second.
  function automatic logic [PositionWidth-1:0] makhoul(input logic [PositionWidth-1:0] p);
    makhoul = {p[PositionWidth-2:0] ^ {(PositionWidth - 1){p[PositionWidth-1]}}, p[PositionWidth-1]};
  endfunction

  logic write_bank, read_bank, read_start, read_active, frame_start, frame_start_q, read_frame_start;
  logic [PositionWidth-1:0] write_position, write_position_q, read_position, write_address, read_address;
  td_burst_counter #(.Words(Columns)) u_read (
    .clk, .rst, .en, .start(read_start), .position(read_position), .active(read_active)
  );
  assign write_position = in_frame_start ? '0 : write_position_q;
  assign write_address = ToBurst != 0 ? write_position : makhoul(write_position);
  assign read_address = ToBurst != 0 ? makhoul(read_position) : read_position;

  td_ram #(.Width(Width), .Depth(2 * Columns)) u_ram (
    .clk,
    .write_en     (en & in_valid),
    .write_address({write_bank, write_address}),
    .write_data   (in_data),
    .read_en      (en & read_active),
    .read_address ({read_bank, read_address}),
    .read_data    (out_data)
  );

  // Of the row that is being collected: it is a frame's first.
  assign frame_start = write_position == '0 ? in_frame_start : frame_start_q;

  logic row_end;
  assign row_end = in_valid & (write_position == PositionWidth'(Columns - 1));

  always_ff @(posedge clk) begin
    if (en) begin
      if (in_valid) begin
        write_position_q <= write_position + PositionWidth'(1);
        frame_start_q <= frame_start;
      end
      if (row_end) begin
        write_bank <= ~write_bank;
        read_bank <= write_bank;
      end
      read_start <= row_end;
      read_frame_start <= row_end & frame_start;
      out_start <= read_start;
      out_frame_start <= read_frame_start;
    end
    if (rst) begin
      write_bank <= 1'b0;
      read_bank <= 1'b0;
      read_start <= 1'b0;
      read_frame_start <= 1'b0;
      out_start <= 1'b0;
      out_frame_start <= 1'b0;
    end
  end

endmodule

`default_nettype wire
