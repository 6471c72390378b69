// SPDX-License-Identifier: Apache-2.0
// gradient_lookup: slopes of a pixel from its colour, through a table.
//
//   {gx, gy} = table[ top bits of R | top bits of G | top bits of B ],  BitsPerChannel of each
//
// Stream in: pixels R in 23:16, B in 15:8, G in 7:0 (the order of AMD's video cores). Stream out: slopes dz/dx, dz/dy,
// z positive into the gel. Latency: 4 cycles; a gap in, a gap out. Table port: docs/streams.md; both banks hold the
// calibration at power-up. Bit-accurate model: models/tactile_depth/chip/gradient/gradient_lookup.py, which also writes
// the table.

`default_nettype none

module gradient_lookup
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter int Width          = 21,  // of a slope; its fraction bits are those of the table
  parameter int BitsPerChannel = 4,
  parameter     File           = "gradient.hex",  // words {gy, gx}
  parameter int Parity         = 0,  // 1: a parity bit in each word
  localparam int IndexWidth = 3 * BitsPerChannel
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire table_command_t     table_command,  // low: gx, high: gy
  output table_answer_t           table_answer,
  input  wire                     table_bank,
  output logic                    table_in_use,
  input  wire                     in_valid,
  input  wire  [23:0]             in_pixel,       // three codes of 8 bits
  input  wire position_t          in_position,
  output logic                    out_valid,
  output position_t               out_position,
  output logic signed [Width-1:0] out_gx,         // slope code
  output logic signed [Width-1:0] out_gy,         // slope code
  output logic                    flipped         // a word that was read has a flipped bit
);

  logic [IndexWidth-1:0] index, index_q;
  assign index = {
    in_pixel[23-:BitsPerChannel], in_pixel[7-:BitsPerChannel], in_pixel[15-:BitsPerChannel]
  };

  logic table_write, table_read;
  logic [IndexWidth-1:0] table_index;
  logic [2*Width-1:0] table_word, free_word;
  td_table_port #(
    .Select(TableSelectGradient), .IndexWidth(IndexWidth), .Width(Width), .Words(2), .Signed(1)
  ) u_port (
    .clk, .rst, .table_command, .table_answer, .write(table_write), .read(table_read), .index(table_index),
    .word(table_word), .free_word
  );

  logic [2:0] valid_q;
  position_t [2:0] position_q;
  logic [2*Width-1:0] word, word_q;
  td_banked_table #(.Width(2 * Width), .Depth(1 << IndexWidth), .File(File), .Parity(Parity)) u_table (
    .clk, .rst, .en, .table_bank, .table_in_use, .flipped,
    .frame_start(in_valid & in_position.first_row & in_position.first_column),
    .change(valid_q[0] & position_q[0].first_row & position_q[0].first_column),
    .read(valid_q[0]), .read_address(index_q), .read_word(word),
    .free_write(table_write), .free_write_address(table_index), .free_write_word(table_word),
    .free_read(table_read), .free_read_address(table_index), .free_word
  );

  always_ff @(posedge clk) begin
    if (en) begin
      index_q <= index;
      word_q <= word;
      {out_gy, out_gx} <= word_q;
      {out_valid, valid_q} <= {valid_q, in_valid};
      {out_position, position_q} <= {position_q, in_position};
    end
    if (rst) {out_valid, valid_q} <= '0;
  end

endmodule

`default_nettype wire
