// SPDX-License-Identifier: Apache-2.0
// gradient_lookup: slopes of a pixel from its colour, through a table.
//
//   {gx, gy} = table[ top bits of R | top bits of G | top bits of B ],  BitsPerChannel of each
//
// Stream in: pixels R in 23:16, B in 15:8, G in 7:0 (the order of AMD's video cores). Stream out: slopes dz/dx, dz/dy,
// z positive into the gel. Latency: 3 cycles. The table is held in two banks, both with the calibration at power-up.
// A frame uses the bank that table_bank names when its first pixel is taken, or in reset; table_in_use says which. The
// other is written by table_write, whenever no change-over is due (table_bank is table_in_use), and read by table_read:
// the entry stands on table_read_* from 3 clocks later until the next, en or not. No table_write from a table_read
// until then. Bit-accurate model: models/gradient_lookup.py, which also writes the table.

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

  // A pixel stays on the output of its bank until en, and the clock that changes over has en: the bank left is free
  // from the next clock on. In that clock itself the other is still being read, so a table_read waits one clock.
  logic bank = 1'b0;  // no reset: it says where the table is, which no reset touches
  logic take, starts, used, changes, late, fetch, fetched, fetched_bank;
  logic [IndexWidth-1:0] late_index, fetch_index;
  assign take = en & in_valid;
  assign starts = take & in_place[0] & in_place[1];
  assign used = starts ? table_bank : bank;  // by the pixel of this clock
  assign changes = used != bank;
  assign fetch = (table_read & ~changes) | late;
  assign fetch_index = late ? late_index : table_index;
  assign table_in_use = bank;

  logic [1:0][2*Width-1:0] words, words_q;
  for (genvar b = 0; b < 2; b++) begin : g_bank
    logic pixel;
    assign pixel = take & (used == 1'(b));
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
      .read_en      (pixel | (fetch & (bank != 1'(b)))),
      .read_address (pixel ? index : fetch_index),
      .read_data    (words[b])
    );
  end

  logic valid_q, valid_q2, bank_q;
  logic [3:0] place_q, place_q2;
  always_ff @(posedge clk) begin
    if (en) begin
      valid_q <= in_valid;
      place_q <= in_place;
      words_q <= words;
      bank_q <= bank;
      valid_q2 <= valid_q;
      place_q2 <= place_q;
      out_valid <= valid_q2;
      out_place <= place_q2;
      {out_gy, out_gx} <= words_q[bank_q];
    end
    if (rst || starts) bank <= table_bank;
    late <= table_read & changes;
    late_index <= table_index;
    fetched <= fetch;
    fetched_bank <= ~bank;
    if (fetched) {table_read_gy, table_read_gx} <= words[fetched_bank];
    if (rst) begin
      valid_q <= 1'b0;
      valid_q2 <= 1'b0;
      out_valid <= 1'b0;
      late <= 1'b0;
      fetched <= 1'b0;
    end
  end

`ifndef SYNTHESIS
  initial if (BitsPerChannel < 1 || BitsPerChannel > 8) $fatal(1, "%m: BitsPerChannel must be 1 to 8");
`endif

endmodule
