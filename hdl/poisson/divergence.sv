// SPDX-License-Identifier: Apache-2.0
// divergence: backward differences of the gradient, exact (no bit dropped).
//
//   f[i,j] = gx[i,j] - gx[i,j-1] + gy[i,j] - gy[i-1,j],  gx[i,-1] = gy[-1,j] = 0
//
// The depth map is shifted by half a pixel up and to the left, because slopes are differenced backwards.
// Stream in: slopes of pixels in raster order. Stream out: the divergence at the same pixels. Latency: 2 cycles; a gap
// in, a gap out. One line of gy is stored. Bit-accurate model: models/tactile_depth/chip/poisson/divergence.py.

`default_nettype none

module divergence
  import td_types_pkg::*;
#(
  parameter int Width   = 21,   // of a slope
  parameter int Columns = 128,
  parameter int Neumann = 0,  // 1: gx of the last column and gy of the last row count as 0
  parameter int Parity  = 0,  // 1: a parity bit in each word of the line
  localparam int OutWidth = Width + 2
) (
  input  wire                        clk,
  input  wire                        rst,
  input  wire                        en,
  input  wire                        in_valid,
  input  wire position_t             in_position,
  input  wire  signed [Width-1:0]    in_gx,            // slope code
  input  wire  signed [Width-1:0]    in_gy,            // slope code
  output logic                       out_valid,
  output logic                       out_frame_start,  // the first pixel of a frame
  output logic signed [OutWidth-1:0] out_data,         // with the fraction bits of a slope
  output logic                       flipped           // a word that was read, or the column, has a flipped bit
);

  localparam int ColumnWidth = $clog2(Columns);
  localparam int LineStyle = Width * Columns > td_memory_pkg::LateBits ? 1 : 0;

  logic [ColumnWidth-1:0] column, column_next;  // of the pixel; one more than that of the pixel before
  assign column = in_position.first_column ? '0 : column_next;

  logic valid_q, first_row_q, first_column_q;
  logic signed [Width-1:0] gx_q, gy_q, gx_left, gy_above, gx_stored, gy_stored;

  // Read while the pixel is taken, written one cycle later, so never the same word at once. The word of a column is at
  // the address behind it.
  logic line_flipped;
  td_parity_ram #(.Width(Width), .Depth(Columns), .Style(LineStyle), .Parity(Parity)) u_line (
    .clk, .en,
    .write_en     (en & valid_q),
    .write_address(column_next),
    .write_data   (gy_q),
    .read_en      (en & in_valid),
    .read_address (column + ColumnWidth'(1)),
    .read_data    (gy_stored),
    .flipped      (line_flipped)
  );
  if (Parity == 0) begin : g_plain
    assign flipped = line_flipped;
  end else begin : g_check
    logic column_wrong;
    assign flipped = line_flipped | column_wrong;
    always_ff @(posedge clk) begin
      column_wrong <= en & in_valid & (in_position.last_column != (column == ColumnWidth'(Columns - 1)));
      if (rst) column_wrong <= 1'b0;
    end
  end
  assign gy_above = first_row_q ? '0 : gy_stored;
  assign gx_left = first_column_q ? '0 : gx_stored;

  always_ff @(posedge clk) begin
    if (en) begin
      if (in_valid) begin
        gx_q <= Neumann != 0 && in_position.last_column ? '0 : in_gx;
        gy_q <= Neumann != 0 && in_position.last_row ? '0 : in_gy;
        column_next <= column + ColumnWidth'(1);
        first_row_q <= in_position.first_row;
        first_column_q <= in_position.first_column;
      end
      if (valid_q) gx_stored <= gx_q;
      valid_q <= in_valid;
      out_valid <= valid_q;
      out_frame_start <= valid_q & first_row_q & first_column_q;
      out_data <= (OutWidth'(gx_q) - OutWidth'(gx_left)) + (OutWidth'(gy_q) - OutWidth'(gy_above));
    end
    if (rst) {valid_q, out_valid, out_frame_start} <= '0;
  end

endmodule

`default_nettype wire
