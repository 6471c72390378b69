// SPDX-License-Identifier: Apache-2.0
// gradient_lookup: slopes of a pixel from its colour, through a table.
//
//   {gx, gy} = table[ top bits of R | top bits of G | top bits of B ],  BitsPerChannel of each
//
// Stream in: pixels R in 23:16, B in 15:8, G in 7:0 (the order of AMD's video cores). Stream out: slopes dz/dx, dz/dy,
// z positive into the gel. Latency: 2 cycles. The table has its calibration at power-up and may be written while no
// frame is in flight. Bit-accurate model: models/gradient_lookup.py, which also writes the table.

module gradient_lookup #(
  parameter int Width          = 21,
  parameter int BitsPerChannel = 4,
  parameter     File           = "gradient.hex",  // words {gy, gx}
  localparam int IndexWidth = 3 * BitsPerChannel
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    en,
  input  logic                    write_en,
  input  logic [IndexWidth-1:0]   write_index,
  input  logic signed [Width-1:0] write_gx,
  input  logic signed [Width-1:0] write_gy,
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

  logic [2*Width-1:0] slopes;
  ram #(
    .Width(2 * Width),
    .Depth(1 << IndexWidth),
    .Style(1),
    .File (File)
  ) u_table (
    .clk,
    .write_en     (write_en),
    .write_address(write_index),
    .write_data   ({write_gy, write_gx}),
    .read_en      (en & in_valid),
    .read_address (index),
    .read_data    (slopes)
  );

  logic valid_q;
  logic [3:0] place_q;
  always_ff @(posedge clk) begin
    if (en) begin
      valid_q <= in_valid;
      place_q <= in_place;
      out_valid <= valid_q;
      out_place <= place_q;
      {out_gy, out_gx} <= slopes;
    end
    if (rst) begin
      valid_q <= 1'b0;
      out_valid <= 1'b0;
    end
  end

endmodule
