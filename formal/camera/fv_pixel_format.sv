// SPDX-License-Identifier: Apache-2.0
// fv_pixel_format: the samples of each pixel of the window, with their marks, in order and in time; breaks too.
//
// YUYV: with coefficients of 0 and 1, so that nothing is rounded: red is Y + Cr - 128, green Y, blue Y + Cb - 128, of the
// pixel's own luma and its pair's chroma. Assumed: pixels of a row come in pairs, even columns first; no pixel comes with
// a break. Nothing is assumed of the other formats.

`default_nettype none

module fv_pixel_format #(
  parameter int Format        = 3,
  parameter int Bits          = 10,
  parameter int MsbAligned    = 1,
  parameter int HighByteFirst = 0,
  parameter int Phase         = 0,
  localparam int Channels = Format == 0 ? 1 : 3,
  localparam int Width = Bits + 2
) (
  input logic        clk,
  input logic        rst,
  input logic        en,
  input logic        in_valid,
  input logic [23:0] in_data,
  input logic        in_inside,
  input logic        in_odd_row,
  input logic        in_odd_column,
  input logic        in_row_start,
  input logic        in_frame_start,
  input logic        in_abort
);

  logic out_valid, out_row_start, out_frame_start, out_abort;
  logic [1:0] out_colour;
  logic [Channels*Width-1:0] out_samples;
  pixel_format #(
    .Format(Format), .Bits(Bits), .MsbAligned(MsbAligned), .HighByteFirst(HighByteFirst), .Phase(Phase), .RedCr(4096),
    .GreenCb(0), .GreenCr(0), .BlueCb(4096)
  ) dut (
    .clk, .rst, .en, .in_valid, .in_data, .in_inside, .in_odd_row, .in_odd_column, .in_row_start, .in_frame_start,
    .in_abort, .out_valid, .out_samples, .out_colour, .out_row_start, .out_frame_start, .out_abort
  );

  logic started = 1'b0;
  always_comb if (!started) assume (rst);
  logic held;
  logic [Channels*Width+3:0] out_q;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    held <= started & ~en & ~rst;
    out_q <= {out_valid, out_abort, out_row_start, out_frame_start, out_samples};
  end
  always_comb if (started && held) holds: assert (out_q == {out_valid, out_abort, out_row_start, out_frame_start, out_samples});

  if (Format != 3) begin : g_word
    logic [Channels*Width-1:0] samples, samples_q;
    logic [5:0] marks_q;
    logic [15:0] pair;
    assign pair = HighByteFirst != 0 ? {in_data[7:0], in_data[15:8]} : in_data[15:0];
    always_comb begin
      samples = '0;
      if (Format == 0) begin
        for (int b = 0; b < Bits; b++) samples[b] = in_data[(MsbAligned != 0 && Bits > 8 ? 16 - Bits : 0)+b];
      end else if (Format == 1) begin
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
    logic expects_odd;  // the first pixel of a pair has come
    always_comb begin
      if (in_valid) assume (in_odd_column == expects_odd);
      assume (!(in_valid && in_abort));
    end
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
        if (in_valid || in_abort) expects_odd <= in_valid & ~in_odd_column;
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
        expects_odd <= 1'b0;
      end
    end
    logic signed [11:0] red, green, blue;
    assign green = 12'({luma[31:24], 2'b00});
    assign red = green + ((12'({1'b0, cr[31:24]}) - 12'd128) <<< 2);
    assign blue = green + ((12'({1'b0, cb[31:24]}) - 12'd128) <<< 2);
    always_comb begin
      if (started) begin
        in_time: assert (out_valid == valid[3] && out_abort == abort[3]);
        not_at_once: assert (!(out_valid && out_abort));
        if (out_valid) begin
          decoded: assert (out_samples == {blue, green, red});
          marked: assert ({out_row_start, out_frame_start} == marks[7:6]);
          second_alone: cover (out_row_start && !valid[2] && red < 0 && blue > 12'sd500);
        end
        broken_behind_a_pair: cover (out_abort && held);
        pairs_without_a_pause: cover (valid == '1 && out_valid);
      end
    end
  end

endmodule

`default_nettype wire
