// SPDX-License-Identifier: Apache-2.0
// gradient_lookup: slopes of a pixel from its colour, through a table.
//
//   {gx, gy} = table[ top bits of R | top bits of G | top bits of B ],  BitsPerChannel of each
//
// Stream in: pixels R in 23:16, B in 15:8, G in 7:0 (the order of AMD's video cores). Stream out: slopes dz/dx, dz/dy,
// z positive into the gel. Latency: 4 cycles. The table is held in two banks, both with the calibration at power-up.
// A frame uses the bank that table_bank names when its first pixel is taken, or in reset; table_in_use says which. The
// other is written by table_write, whenever no change-over is due (table_bank is table_in_use), and read by table_read:
// the entry stands on table_read_* from 2 clocks later until the next, en or not. Asked for in the clock of a
// change-over it is of the bank that comes into use. Bit-accurate model:
// models/tactile_depth/gradient/gradient_lookup.py, which also writes
// the table.

module gradient_lookup #(
  parameter int Width          = 21,
  parameter int BitsPerChannel = 4,
  parameter     File           = "gradient.hex",  // words {gy, gx}
  localparam int IndexWidth = 3 * BitsPerChannel
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    en,
  input  logic                    table_bank,
  output logic                    table_in_use,
  input  logic                    table_write,
  input  logic                    table_read,
  input  logic [IndexWidth-1:0]   table_index,
  input  logic signed [Width-1:0] table_gx,
  input  logic signed [Width-1:0] table_gy,
  output logic signed [Width-1:0] table_read_gx,
  output logic signed [Width-1:0] table_read_gy,
  input  logic                    in_valid,
  input  logic [23:0]             in_pixel,
  input  logic [3:0]              in_place,   // in the first row, first column, last row, last column
  output logic                    out_valid,
  output logic [3:0]              out_place,
  output logic signed [Width-1:0] out_gx,
  output logic signed [Width-1:0] out_gy
);

  logic [IndexWidth-1:0] index;
  assign index = {
    in_pixel[23-:BitsPerChannel], in_pixel[7-:BitsPerChannel], in_pixel[15-:BitsPerChannel]
  };
  if (BitsPerChannel < 8) begin : g_unused
    logic unused_bits;
    assign unused_bits = ^{
      in_pixel[23-BitsPerChannel:16], in_pixel[15-BitsPerChannel:8], in_pixel[7-BitsPerChannel:0]
    };
  end

  // The bank changes as the first pixel of a frame gets here, so it is that of the pixel that is about to be read, and
  // nothing that comes in with the pixel reaches an address.
  logic bank = 1'b0;  // no reset: it says where the table is, which no reset touches
  logic valid_q, valid_q2, valid_q3;
  logic [3:0] place_q, place_q2, place_q3;
  logic [IndexWidth-1:0] index_q;
  assign table_in_use = bank;

  logic [1:0][2*Width-1:0] words;
  for (genvar b = 0; b < 2; b++) begin : g_bank
    ram #(
      .Width(2 * Width),
      .Depth(1 << IndexWidth),
      .Style(1),
      .File (File)
    ) u_table (
      .clk,
      .write_en     (table_write & (bank != 1'(b))),
      .write_address(table_index),
      .write_data   ({table_gy, table_gx}),
      .read_en      (bank == 1'(b) ? en & valid_q : table_read),
      .read_address (bank == 1'(b) ? index_q : table_index),
      .read_data    (words[b])
    );
  end

  // What is read for the last pixel before a change-over stands there for a clock, then its bank may be software's, and
  // the pipeline may not have moved: it is kept. No two pixels in a row are the last ones of their frames.
  logic starts, starts_q, bank_read, left_q, bank_q, fetched, fetched_bank;
  logic [1:0][2*Width-1:0] words_q, kept;
  assign starts = en & in_valid & in_place[0] & in_place[1];

  always_ff @(posedge clk) begin
    if (en) begin
      valid_q <= in_valid;
      place_q <= in_place;
      index_q <= index;
      valid_q2 <= valid_q;
      place_q2 <= place_q;
      bank_read <= bank;
      valid_q3 <= valid_q2;
      place_q3 <= place_q2;
      words_q <= words;
      bank_q <= bank_read;
      left_q <= bank_read != bank;
      out_valid <= valid_q3;
      out_place <= place_q3;
      {out_gy, out_gx} <= left_q ? kept[bank_q] : words_q[bank_q];
    end
    if (rst || starts) bank <= table_bank;
    starts_q <= starts;
    if (starts_q) kept <= words;
    fetched <= table_read;
    fetched_bank <= ~bank;
    if (fetched) {table_read_gy, table_read_gx} <= words[fetched_bank];
    if (rst) begin
      valid_q <= 1'b0;
      valid_q2 <= 1'b0;
      valid_q3 <= 1'b0;
      out_valid <= 1'b0;
      fetched <= 1'b0;
    end
  end

`ifndef SYNTHESIS
  initial if (BitsPerChannel < 1 || BitsPerChannel > 8) $fatal(1, "%m: BitsPerChannel must be 1 to 8");
`endif

endmodule
