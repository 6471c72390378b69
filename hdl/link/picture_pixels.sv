// SPDX-License-Identifier: Apache-2.0
// picture_pixels: packets of pixels to video. What a lost packet leaves out stops a picture, so that it is malformed.
//
// A packet in, bytes under valid and ready: number of the picture (4 bytes, low byte first), row (2), column (2) of its
// first pixel, then red, green and blue of each pixel in raster order. Its pixels are taken if it begins a picture (row
// 0, column 0), or continues it: the number of the picture that began, row and column of its next pixel. Other packets
// are dropped, and so is what comes behind a picture's last pixel, or behind the last whole pixel of a packet.
//
// Stream out: AXI4-Stream Video, red in 23 to 16, blue in 15 to 8, green in 7 to 0. Latency: a pixel is offered the
// clock after its last byte; until it is taken no byte is. Model: models/tactile_depth/chip/link/picture_pixels.py.

`default_nettype none

module picture_pixels #(
  parameter int Rows    = 128,
  parameter int Columns = 128
) (
  input  wire         clk,
  input  wire         rst,
  input  wire         picture_valid,
  output logic        picture_ready,
  input  wire  [7:0]  picture_data,
  input  wire         picture_last,
  output logic [23:0] m_axis_tdata,
  output logic        m_axis_tvalid,
  input  wire         m_axis_tready,
  output logic        m_axis_tlast,
  output logic        m_axis_tuser
);

  localparam int RowWidth = $clog2(Rows + 1);
  localparam int ColumnWidth = $clog2(Columns + 1);
  localparam logic [2:0] RowPlace = 3'd4;     // of its first byte in the header
  localparam logic [2:0] HeaderEnd = 3'd7;
  localparam logic [2:0] Blue = 3'd2;

  logic open;            // the picture that began still lacks pixels: the next one
  logic [RowWidth-1:0] row;
  logic [ColumnWidth-1:0] column;
  logic [31:0] number;   // of that picture

  // The header is compared as it comes.

  logic takes, in_pixels, begins, continues, all_zero, all_equal;
  logic [2:0] place;     // of the next byte, in the header or in its pixel
  logic [31:0] new_number;
  logic [63:0] expected;
  assign picture_ready = ~m_axis_tvalid;
  assign takes = picture_valid & picture_ready;
  assign expected = {16'(column), 16'(row), number};
  assign begins = (place == RowPlace || all_zero) && picture_data == '0;
  assign continues = (place == '0 || all_equal) && picture_data == 8'(expected >> {place, 3'd0});

  // Pixels.

  logic wanted, pixel_whole, last_column, last_row;
  assign pixel_whole = takes & in_pixels & (place == Blue);
  assign last_column = column == ColumnWidth'(Columns - 1);
  assign last_row = row == RowWidth'(Rows - 1);

  always_ff @(posedge clk) begin
    if (m_axis_tready) m_axis_tvalid <= 1'b0;
    if (takes) begin
      place <= place + 3'd1;
      all_zero <= begins;
      all_equal <= continues;
      if (!in_pixels && place < RowPlace) new_number <= {picture_data, new_number[31:8]};
      if (!in_pixels && place == HeaderEnd) begin
        in_pixels <= 1'b1;
        wanted <= begins | continues;
        if (begins) begin
          open <= 1'b1;
          number <= new_number;
          row <= '0;
          column <= '0;
        end
      end
      if (in_pixels && place == 3'd0) m_axis_tdata[23:16] <= picture_data;
      if (in_pixels && place == 3'd1) m_axis_tdata[7:0] <= picture_data;
      if (in_pixels && place == Blue) m_axis_tdata[15:8] <= picture_data;
      if (pixel_whole) place <= '0;
      if (picture_last) begin
        place <= '0;
        in_pixels <= 1'b0;
      end
    end
    if (pixel_whole && wanted && open) begin
      m_axis_tvalid <= 1'b1;
      m_axis_tlast <= last_column;
      m_axis_tuser <= row == '0 && column == '0;
      column <= last_column ? '0 : column + ColumnWidth'(1);
      if (last_column) row <= row + RowWidth'(1);
      if (last_column && last_row) open <= 1'b0;
    end
    if (rst) begin
      open <= 1'b0;
      place <= '0;
      in_pixels <= 1'b0;
      m_axis_tvalid <= 1'b0;
    end
  end

endmodule

`default_nettype wire
