// SPDX-License-Identifier: Apache-2.0
// fv_gradient_lookup: the slopes of a pixel are those that stand in the table at the index of its colour, from power-up or
// as last written; valid and place travel with it, 2 enabled clocks; while en is low all outputs hold.
//
// Assumed: nothing is written while a pixel is present or between the table and its register (axil_registers: never
// while busy).

module fv_gradient_lookup #(
  parameter int Width          = 1,
  parameter int BitsPerChannel = 1,
  localparam int IndexWidth = 3 * BitsPerChannel
) (
  input logic                    clk,
  input logic                    rst,
  input logic                    en,
  input logic                    write_en,
  input logic [IndexWidth-1:0]   write_index,
  input logic signed [Width-1:0] write_gx,
  input logic signed [Width-1:0] write_gy,
  input logic                    in_valid,
  input logic [23:0]             in_pixel,
  input logic [3:0]              in_place
);

  logic out_valid;
  logic [3:0] out_place;
  logic signed [Width-1:0] out_gx, out_gy;
  gradient_lookup #(.Width(Width), .BitsPerChannel(BitsPerChannel)) dut (
    .clk, .rst, .en, .write_en, .write_index, .write_gx, .write_gy, .in_valid, .in_pixel, .in_place,
    .out_valid, .out_place, .out_gx, .out_gy
  );

  logic started = 1'b0;
  always_comb if (!started) assume (rst && !write_en);

  // The table as the register map describes it: red uppermost, then green, then blue.
  logic [2*Width-1:0] words[1 << IndexWidth];
  initial $readmemh("gradient.hex", words);
  logic [BitsPerChannel-1:0] red, green, blue;
  assign red = in_pixel[23:16] >> (8 - BitsPerChannel);
  assign blue = in_pixel[15:8] >> (8 - BitsPerChannel);
  assign green = in_pixel[7:0] >> (8 - BitsPerChannel);
  logic [IndexWidth-1:0] index;
  assign index = (IndexWidth'(red) << (2 * BitsPerChannel)) + (IndexWidth'(green) << BitsPerChannel) + IndexWidth'(blue);

  logic [1:0] valid;   // of the pixels 1 and 2 enabled clocks ago
  logic [7:0] place;
  logic [4*Width-1:0] slopes;
  logic written, held;
  logic [4+2*Width:0] out_q;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    held <= ~en & ~rst;
    out_q <= {out_valid, out_place, out_gx, out_gy};
    if (write_en) words[write_index] <= {write_gy, write_gx};
    written <= ~rst & (written | write_en);
    if (en) begin
      valid <= {valid[0], in_valid};
      place <= {place[3:0], in_place};
      slopes <= {slopes[2*Width-1:0], words[index]};
    end
    if (rst) valid <= '0;
  end
  always_comb if (in_valid || valid[0]) assume (!write_en);

  always_comb begin
    if (started) begin
      valid_travels: assert (out_valid == valid[1]);
      if (out_valid) place_travels: assert (out_place == place[7:4]);
      if (out_valid) slopes_of_index: assert ({out_gy, out_gx} == slopes[2*Width+:2*Width]);
      if (held) holds: assert ({out_valid, out_place, out_gx, out_gy} == out_q);
      from_power_up: cover (out_valid && !written);
      from_write: cover (out_valid && written && in_valid && valid == 2'b11 && held);
    end
  end

  bind fv_gradient_lookup.dut.u_table ram_check #(.Depth(Depth), .Defined(0)) u_check (
    .clk, .write_en, .write_address, .read_en, .read_address
  );

endmodule
