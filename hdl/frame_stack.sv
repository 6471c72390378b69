// SPDX-License-Identifier: Apache-2.0
// frame_stack: rows of a frame in, last row first out, through one memory of exactly Rows x Size words.
//
// Stream in: bursts of Size words, Rows of them a frame, gaps between bursts anywhere; rows count from a frame's start.
// Stream out: Rows bursts without a pause. Latency: 2 cycles from the first word of the last row to the first word out;
// nothing need follow, the reader runs by itself.
//
// In place: while row Rows - 1 - r of a frame is read, row r of the next frame cannot have begun; it is written into
// the freed place. So the order of rows in the memory is the reverse of the frame read last. Bit-accurate model:
// models/frame_stack.py.

module frame_stack #(
  parameter int Width = 24,
  parameter int Rows  = 128,
  parameter int Size  = 128
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic             in_start,
  input  logic             in_frame_start,   // with in_start: the first burst of a frame
  input  logic [Width-1:0] in_data,
  output logic             out_start,
  output logic             out_frame_start,
  output logic [Width-1:0] out_data
);

  localparam int PositionWidth = $clog2(Size);
  localparam int RowWidth = $clog2(Rows);
  localparam int UltraBits = 16 * 36864;  // from here a frame store is cheaper in ultra than in block RAM
  localparam logic [RowWidth-1:0] LastRow = RowWidth'(Rows - 1);

  // Writer. flipped: row 0 of this frame lies at the top of the memory.
  logic [PositionWidth-1:0] write_position, read_position;
  logic [RowWidth-1:0] row, row_q, step, step_q;
  logic write_active, write_flipped, write_flipped_q, read_flipped, last_row_start;
  burst_counter #(.Size(Size)) u_write (
    .clk, .rst, .en, .start(in_start), .position(write_position), .active(write_active)
  );
  assign row = in_frame_start ? '0 : row_q;
  assign write_flipped = in_frame_start ? ~read_flipped : write_flipped_q;
  assign last_row_start = in_start & (row == LastRow);

  // Reader: step r reads row Rows - 1 - r.
  logic read_start, read_begin, read_more, read_active;
  assign read_start = read_begin | read_more;
  assign step = read_begin ? '0 : step_q;
  burst_counter #(.Size(Size)) u_read (
    .clk, .rst, .en, .start(read_start), .position(read_position), .active(read_active)
  );

  ram #(
    .Width(Width),
    .Depth(Rows * Size),
    .Style(Rows * Size * Width >= UltraBits ? 2 : 1)
  ) u_ram (
    .clk,
    .write_en     (en & write_active),
    .write_address({write_flipped ? LastRow - row : row, write_position}),
    .write_data   (in_data),
    .read_en      (en & read_active),
    .read_address ({read_flipped ? step : LastRow - step, read_position}),
    .read_data    (out_data)
  );

  logic read_row_end;
  assign read_row_end = read_active & (read_position == PositionWidth'(Size - 1));

  always_ff @(posedge clk) begin
    if (en) begin
      row_q <= row + RowWidth'(write_active & (write_position == PositionWidth'(Size - 1)));
      write_flipped_q <= write_flipped;
      if (last_row_start) read_flipped <= write_flipped;
      read_begin <= last_row_start;
      read_more <= read_row_end & (step != LastRow);
      step_q <= step + RowWidth'(read_row_end);
      out_start <= read_start;
      out_frame_start <= read_begin;
    end
    if (rst) begin
      read_flipped <= 1'b0;
      read_begin <= 1'b0;
      read_more <= 1'b0;
      out_start <= 1'b0;
      out_frame_start <= 1'b0;
    end
  end

endmodule
