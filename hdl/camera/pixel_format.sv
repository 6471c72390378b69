// SPDX-License-Identifier: Apache-2.0
// pixel_format: samples of the pixels of a window, from words in the format of the camera.
//
//   Format                 word of a pixel                                          samples
//   RAW8, RAW10, RAW12     7:0, or at the top of 15:0; *_LSB: at its bottom         one, of a Bayer pattern
//   RGB888                 R in 23:16, B in 15:8, G in 7:0                          three
//   RGB565                 R in 15:11, G in 10:5, B in 4:0; *_BYTES: exchanged      three, upper bits repeated below
//   YUYV                   Y in 7:0; in 15:8 Cb of even columns, Cr of odd ones     three, BT.601 of full range
//
// Format is a number of camera_format_e (registers/camera.rdl). A sample is signed, 2^Bits is full scale. YUYV: R = Y +
// RedCr (Cr - 128) / 2^12 and so on, rounded half to even to quarters of a grey level, below 0 and above white too.
// Phase: bit 0 the first column of the picture has blue pixels, bit 1 the first row has.
// Stream in: the pixels of a picture in raster order, in_inside with those of the window. Stream out: those of the
// window, with their marks and colour (bit 0 a column of blue, bit 1 a row of blue). in_abort passes behind them.
// Latency: 1 cycle with en. YUYV: 3 and 4 from the second pixel of a pair, in_abort 4. en low: nothing moves.
// Bit-accurate model: models/tactile_depth/chip/camera/pixel_format.py.

`default_nettype none

module pixel_format
  import td_camera_map_pkg::*;
#(
  parameter int Format = CameraFormatRaw10,
  parameter int Phase  = 0,
  localparam int Bits = format_bits(Format),
  localparam int Channels = format_is_bayer(Format) != 0 ? 1 : 3,
  localparam int Width = Bits + 2
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire                       in_valid,
  input  wire  [23:0]               in_data,
  input  wire                       in_inside,
  input  wire                       in_odd_row,
  input  wire                       in_odd_column,
  input  wire                       in_row_start,
  input  wire                       in_frame_start,
  input  wire                       in_abort,
  output logic                      out_valid,
  output logic [Channels*Width-1:0] out_samples,  // signed, red lowest
  output logic [1:0]                out_colour,
  output logic                      out_row_start,
  output logic                      out_frame_start,
  output logic                      out_abort
);

  if (format_is_yuyv(Format) == 0) begin : g_word
    logic [Channels*Width-1:0] samples;
    if (format_is_bayer(Format) != 0) begin : g_raw
      localparam int Lowest = Format == CameraFormatRaw10 || Format == CameraFormatRaw12 ? 16 - Bits : 0;
      assign samples = Width'(Bits'(in_data >> Lowest));
    end else if (Format == CameraFormatRgb888) begin : g_rgb888
      assign samples = {Width'(in_data[15:8]), Width'(in_data[7:0]), Width'(in_data[23:16])};
    end else begin : g_rgb565
      logic [4:0] red, blue;
      logic [5:0] green;
      assign {red, green, blue} = Format == CameraFormatRgb565Bytes ? {in_data[7:0], in_data[15:8]} : in_data[15:0];
      assign samples = {
        Width'({blue, blue[4:2]}), Width'({green, green[5:4]}), Width'({red, red[4:2]})
      };
    end
    always_ff @(posedge clk) begin
      if (en) begin
        out_valid <= in_valid & in_inside;
        out_samples <= samples;
        out_colour <= {in_odd_row, in_odd_column} ^ 2'($unsigned(Phase));
        out_row_start <= in_row_start;
        out_frame_start <= in_frame_start;
        out_abort <= in_abort;
      end
      if (rst) {out_valid, out_abort} <= '0;
    end
  end else begin : g_yuyv
    // A pair is known with its second pixel. Its first leaves at once, its second in the next cycle.
    localparam int Chroma = 8;
    localparam int Coefficient = 14;
    localparam int Product = Chroma + Coefficient;
    localparam int Fraction = 12;
    logic [7:0] first_luma, second_luma, first_chroma;
    logic first_inside, first_row_start, first_frame_start;
    logic second_waits, second_row_start, second_frame_start, pair;
    logic [2:0] valid, row_start, frame_start;
    logic [3:0] abort;
    logic [7:0] luma, luma_q;
    logic signed [Chroma-1:0] cb, cr;
    assign pair = in_valid & in_odd_column;
    assign out_valid = valid[2];
    assign out_row_start = row_start[2];
    assign out_frame_start = frame_start[2];
    assign out_abort = abort[3];
    assign out_colour = '0;
    always_ff @(posedge clk) begin
      if (en) begin
        if (in_valid & ~in_odd_column) begin
          {first_chroma, first_luma} <= in_data[15:0];
          {first_inside, first_row_start, first_frame_start} <= {in_inside, in_row_start, in_frame_start};
        end
        if (pair) begin
          cb <= first_chroma ^ 8'h80;  // less 128
          cr <= in_data[15:8] ^ 8'h80;
          second_luma <= in_data[7:0];
          {second_row_start, second_frame_start} <= {in_row_start, in_frame_start};
        end
        second_waits <= pair & in_inside;
        luma <= pair ? first_luma : second_luma;
        luma_q <= luma;
        valid <= {valid[1:0], pair ? first_inside : second_waits};
        row_start <= {row_start[1:0], pair ? first_row_start : second_row_start};
        frame_start <= {frame_start[1:0], pair ? first_frame_start : second_frame_start};
        abort <= {abort[2:0], in_abort};
      end
      if (rst) {second_waits, valid, abort} <= '0;
    end

    logic signed [Product-1:0] red_cr, green_cb, green_cr, blue_cb;
    td_multiply #(.AWidth(Chroma), .BWidth(Coefficient)) u_red_cr (
      .clk, .en, .a(cr), .b(Coefficient'(RedCr)), .product(red_cr)
    );
    td_multiply #(.AWidth(Chroma), .BWidth(Coefficient)) u_green_cb (
      .clk, .en, .a(cb), .b(Coefficient'(GreenCb)), .product(green_cb)
    );
    td_multiply #(.AWidth(Chroma), .BWidth(Coefficient)) u_green_cr (
      .clk, .en, .a(cr), .b(Coefficient'(GreenCr)), .product(green_cr)
    );
    td_multiply #(.AWidth(Chroma), .BWidth(Coefficient)) u_blue_cb (
      .clk, .en, .a(cb), .b(Coefficient'(BlueCb)), .product(blue_cb)
    );
    logic signed [Product+1:0] grey, red, green, blue;
    logic [2:0][Product+1:0] colours;
    assign grey = (Product + 2)'({luma_q, {Fraction{1'b0}}});
    assign red = grey + (Product + 2)'(red_cr);
    assign green = grey + (Product + 2)'(green_cb) + (Product + 2)'(green_cr);
    assign blue = grey + (Product + 2)'(blue_cb);
    assign colours = {blue, green, red};
    for (genvar c = 0; c < 3; c++) begin : g_round
      logic signed [Width-1:0] rounded;
      td_round_saturate #(.InWidth(Product + 2), .Drop(Fraction + 8 - Bits), .OutWidth(Width)) u_round (
        .in(colours[c]), .out(rounded), .clipped()
      );
      always_ff @(posedge clk) if (en) out_samples[c*Width+:Width] <= rounded;
    end
  end

endmodule

`default_nettype wire
