// SPDX-License-Identifier: Apache-2.0
// td_block_sum: sums of the words in blocks of 2^BlockLog2 rows by 2^ColumnLog2 words, over one frame or several.
//
//   sum of a block = all its words in the frames since a first one, modulo 2^SumWidth
//
// The sums are in a memory with a word for each block, blocks row by row. The words of a block in one row are
// added up first. Their sum is then added to that in the memory; in the block's first row of a first frame it replaces
// what is there. Rows below the last whole block belong to no block.
// Stream in: words of whole frames, raster order, the channels side by side; gaps change no sum. in_first_frame and
// in_last_frame count with in_frame_start. Latency: the memory is written 5 cycles after the last word of a block's
// row; write_complete: with it the sum holds the whole block of a last frame. The memory answers 1 cycle after read_en.
// Bit-accurate model: models/tactile_depth/chip/common/td_block_sum.py.

`default_nettype none

module td_block_sum #(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int ColumnLog2 = BlockLog2,  // of the words in a row of a block
  parameter int Channels  = 1,
  parameter int Width     = 24,  // of a word
  parameter int Signed    = 1,   // 1: words are signed
  parameter int SumWidth  = 38,
  localparam int BlockRows = Rows / (1 << BlockLog2),
  localparam int BlockColumns = Columns / (1 << ColumnLog2),
  localparam int BlockWidth = $clog2(BlockRows * BlockColumns)
) (
  input  wire                          clk,
  input  wire                          rst,             // sums under way are not written
  input  wire                          in_valid,
  input  wire                          in_frame_start,
  input  wire                          in_first_frame,  // sums begin with this frame
  input  wire                          in_last_frame,   // sums are complete with this frame
  input  wire  [Channels*Width-1:0]    in_data,
  output logic                         read_en,
  output logic [BlockWidth-1:0]        read_block,
  input  wire  [Channels*SumWidth-1:0] read_sums,
  output logic                         write_en,
  output logic [BlockWidth-1:0]        write_block,
  output logic [Channels*SumWidth-1:0] write_sums,
  output logic                         write_complete
);

  localparam int ColumnWidth = $clog2(Columns);
  localparam int RowWidth = $clog2(Rows) + 1;
  localparam int RowSumWidth = Width + ColumnLog2;
  localparam logic [ColumnWidth-1:0] InBlock = ColumnWidth'((1 << ColumnLog2) - 1);  // bits of the column

  logic valid_q, first_frame, last_frame;
  logic [Channels*Width-1:0] data_q;
  logic [RowWidth-1:0] row;
  logic [ColumnWidth-1:0] column;

  // A block's row ends; its sum begins, or is complete.
  logic row_ends, begins, completes;
  logic [3:0] row_ends_q = '0;  // a cycle before the first reset writes nothing
  logic [3:0] completes_q;
  logic [2:0] begins_q;
  logic [BlockWidth-1:0] block;
  logic [3:0][BlockWidth-1:0] block_q;
  assign row_ends = valid_q & (column & InBlock) == InBlock & row < RowWidth'($unsigned(BlockRows << BlockLog2));
  assign begins = first_frame & row[BlockLog2-1:0] == '0;
  assign completes = last_frame & row[BlockLog2-1:0] == '1;
  assign block = BlockWidth'({row[RowWidth-1:BlockLog2], column[ColumnWidth-1:ColumnLog2]});

  assign read_en = row_ends_q[0] & ~begins_q[0];
  assign read_block = block_q[0];
  assign write_en = row_ends_q[3];
  assign write_block = block_q[3];
  assign write_complete = row_ends_q[3] & completes_q[3];

  always_ff @(posedge clk) begin
    valid_q <= in_valid;
    if (in_valid) begin
      {row, column} <= in_frame_start ? '0 : {row, column} + (RowWidth + ColumnWidth)'(1);
      data_q <= in_data;
      if (in_frame_start) {first_frame, last_frame} <= {in_first_frame, in_last_frame};
    end
    row_ends_q <= {row_ends_q[2:0], row_ends};
    begins_q <= {begins_q[1:0], begins};
    completes_q <= {completes_q[2:0], completes};
    block_q <= {block_q[2:0], block};
    if (rst) begin
      valid_q <= 1'b0;
      row_ends_q <= '0;
    end
  end

  for (genvar c = 0; c < Channels; c++) begin : g_channel
    logic [Width-1:0] word;
    logic [RowSumWidth-1:0] row_sum;
    logic [1:0][RowSumWidth-1:0] row_sum_q;
    logic [SumWidth-1:0] sum, sum_read;
    assign word = data_q[c*Width+:Width];
    assign write_sums[c*SumWidth+:SumWidth] = sum;
    always_ff @(posedge clk) begin
      if (valid_q) begin
        row_sum <= ((column & InBlock) == '0 ? '0 : row_sum)
            + (Signed != 0 ? RowSumWidth'($signed(word)) : RowSumWidth'(word));
      end
      row_sum_q <= {row_sum_q[0], row_sum};
      sum_read <= read_sums[c*SumWidth+:SumWidth];
      sum <= (begins_q[2] ? '0 : sum_read)
          + {{(SumWidth - RowSumWidth) {Signed != 0 & row_sum_q[1][RowSumWidth-1]}}, row_sum_q[1]};
    end
  end

  if (BlockLog2 < 1) begin : g_refused_0
    BlockLog2_must_be_at_least_1 u_refused ();
  end
  if (Columns != 1 << ColumnWidth) begin : g_refused_1
    Columns_must_be_a_power_of_two u_refused ();
  end
  if (BlockColumns < 2 || BlockRows < 1) begin : g_refused_2
    two_blocks_a_row_and_one_a_column_are_needed u_refused ();
  end
  if (SumWidth <= RowSumWidth) begin : g_refused_3
    SumWidth_must_be_more_than_Width_plus_ColumnLog2 u_refused ();
  end
  if (Columns < 4) begin : g_refused_4
    four_words_a_row_are_needed_an_addition_takes_three_clocks u_refused ();
  end

endmodule

`default_nettype wire
