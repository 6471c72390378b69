// SPDX-License-Identifier: Apache-2.0
// fv_pixel_format: the samples of each pixel of the window, with their marks, in order and in time; breaks too.
//
// YUYV: BT.601 of the pixel's own luma and its pair's chroma, rounded half to even.

parameter int Format = CameraFormatYuyv, Phase = 0;

logic held;
kept #(.Width(Channels * Width + 4)) u_kept (
  .clk, .rst, .en, .out({out_valid, out_abort, out_row_start, out_frame_start, out_samples}), .held
);

if (format_is_yuyv(Format) == 0) begin : g_word
  logic [Channels*Width-1:0] samples, samples_q;
  logic [5:0] marks_q;
  logic [15:0] pair;
  assign pair = Format == CameraFormatRgb565Bytes ? {in_data[7:0], in_data[15:8]} : in_data[15:0];
  always_comb begin
    samples = '0;
    if (format_is_bayer(Format) != 0) begin
      for (int b = 0; b < Bits; b++) begin
        samples[b] = in_data[(Format == CameraFormatRaw10 ? 6 : Format == CameraFormatRaw12 ? 4 : 0)+b];
      end
    end else if (Format == CameraFormatRgb888) begin
      samples[0+:8] = in_data[23:16];
      samples[Width+:8] = in_data[7:0];
      samples[2*Width+:8] = in_data[15:8];
    end else begin
      samples[0+:8] = {pair[15:11], pair[15:13]};
      samples[Width+:8] = {pair[10:5], pair[10:9]};
      samples[2*Width+:8] = {pair[4:0], pair[4:2]};
    end
  end
  always_ff @(posedge clk) begin
    if (en) begin
      samples_q <= samples;
      marks_q <= {in_valid & in_inside, in_abort, in_odd_row, in_odd_column, in_row_start, in_frame_start};
    end
    if (rst) marks_q[5:4] <= '0;
  end
  always_comb begin
    if (started) begin
      in_time: assert ({out_valid, out_abort} == marks_q[5:4]);
      if (out_valid) begin
        decoded: assert (out_samples == samples_q);
        marked: assert ({out_row_start, out_frame_start} == marks_q[1:0]);
        coloured: assert (out_colour == (marks_q[3:2] ^ 2'(Phase)));
      end
      pixel: cover (out_valid && out_samples != '0 && held);
      broken: cover (out_abort);
    end
  end
end else begin : g_pair
  // What leaves in so many clocks: of the pair that is complete now its first in 3, its second in 4.
  logic [15:0] first;
  logic [2:0] first_marks;
  logic [3:0] valid, abort;
  logic [7:0] marks;
  logic [31:0] luma, cb, cr;
  logic pair;
  assign pair = in_valid & in_odd_column;
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_valid && !in_odd_column) begin
        first <= in_data[15:0];
        first_marks <= {in_inside, in_row_start, in_frame_start};
      end
      valid <= {valid[2:1], pair ? first_marks[2] : valid[0], pair & in_inside};
      marks <= {marks[5:2], pair ? first_marks[1:0] : marks[1:0], in_row_start, in_frame_start};
      luma <= {luma[23:8], pair ? first[7:0] : luma[7:0], in_data[7:0]};
      cb <= {cb[23:8], pair ? first[15:8] : cb[7:0], first[15:8]};
      cr <= {cr[23:8], pair ? in_data[15:8] : cr[7:0], in_data[15:8]};
      abort <= {abort[2:0], in_abort};
    end
    if (rst) begin
      valid <= '0;
      abort <= '0;
    end
  end
  logic signed [21:0] red_cr, green_cb, green_cr, blue_cb;
  logic signed [23:0] grey, red_sum, green_sum, blue_sum;
  logic signed [11:0] red, green, blue;
  assign grey = 24'({luma[23:16], 12'd0});
  always_ff @(posedge clk) begin
    if (en) begin
      red_cr <= $signed(cr[15:8] ^ 8'h80) * 14'(RedCr);
      green_cb <= $signed(cb[15:8] ^ 8'h80) * 14'(GreenCb);
      green_cr <= $signed(cr[15:8] ^ 8'h80) * 14'(GreenCr);
      blue_cb <= $signed(cb[15:8] ^ 8'h80) * 14'(BlueCb);
      red_sum <= grey + 24'(red_cr);
      green_sum <= grey + 24'(green_cb) + 24'(green_cr);
      blue_sum <= grey + 24'(blue_cb);
    end
  end
  function automatic logic signed [11:0] rounded(input logic signed [23:0] sum);  // ties: where what stays is odd
    return 12'((sum + 24'sd511 + 24'({1'b0, sum[10]})) >>> 10);
  endfunction
  assign red = rounded(red_sum);
  assign green = rounded(green_sum);
  assign blue = rounded(blue_sum);
  always_comb begin
    if (started) begin
      in_time: assert (out_valid == valid[3] && out_abort == abort[3]);
      not_at_once: assert (!(out_valid && out_abort));
      if (out_valid) begin
        decoded: assert (out_samples == {blue, green, red});
        marked: assert ({out_row_start, out_frame_start} == marks[7:6]);
        second_alone: cover (out_row_start && !valid[2] && red < 0 && blue > 12'sd1500);
      end
      broken_behind_a_pair: cover (out_abort && held);
      pairs_without_a_pause: cover (valid == '1 && out_valid);
    end
  end
end

// Protocol: pixels of YUYV come in pairs, a break without a pixel; any others. Samples and marks count with
// out_valid, the colour of a pixel in RAW formats alone.
module protocol_pixel_format;
  logic expects_odd = 1'b0, pixel;
  assign holds = rst | ~in_valid | format_is_yuyv(Format) == 0 | (~in_abort & in_odd_column == expects_odd);
  always_ff @(posedge clk) begin
    if (en && (in_valid || in_abort)) expects_odd <= in_valid & ~in_odd_column;
    if (reset) expects_odd <= 1'b0;
  end
  assign counts = live & ~reset;
  assign pixel = counts & out_valid;
  assign {counts_out_samples, counts_out_row_start, counts_out_frame_start} = {3{pixel}};
  assign counts_out_colour = pixel & (format_is_bayer(Format) != 0);
endmodule
