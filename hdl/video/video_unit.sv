// SPDX-License-Identifier: Apache-2.0
// video_unit: the pixels of whole frames from an AXI4-Stream Video input, with their position and the time of the
// frame.
//
//   s_axis -> td_axis_skid -+-> test_picture -> frame_guard -> pixel
//                           +-> td_frame_size -> arrived_columns, arrived_rows
//
// Stream in: 24-bit pixels, raster order, ready/valid. Stream out: Rows x Columns pixels a frame, under `en`; with the
// first of a frame pixel_frame_start, with the last pixel_frame_end, and pixel_bad if the frame was malformed; the
// picture of a self-test is marked as malformed too, and by pixel_test.
// Latency: 2 cycles. A gap in, a gap out. Model: models/tactile_depth/chip/video/frame_guard.py.

`default_nettype none

module video_unit
  import td_config_pkg::*;
  import td_types_pkg::*;
#(
  parameter logic [ConfigBits-1:0] Config = DefaultConfig,
  localparam int Rows    = value(Config, RowsField),
  localparam int Columns = value(Config, ColumnsField)
) (
  input  wire         clk,
  input  wire         rst,
  input  wire         en,

  input  wire  [23:0] s_axis_tdata,
  input  wire         s_axis_tvalid,
  output logic        s_axis_tready,
  input  wire         s_axis_tlast,
  input  wire         s_axis_tuser,

  input  wire         self_test,  // asks for the picture of a self-test
  input  wire  [31:0] timeout,  // of a source that falls silent inside a frame, in cycles; 0: none
  output faults_t     faults,
  output logic        hunting,  // pixels are dropped up to the next start of frame
  output logic [13:0] arrived_columns,  // of td_frame_size
  output logic [13:0] arrived_rows,
  output logic        busy,     // a pixel waits, or a frame has begun and not ended

  output logic        pixel_valid,
  output logic [23:0] pixel_data,  // R in 23:16, B in 15:8, G in 7:0
  output position_t   pixel_position,
  output logic        pixel_frame_start,
  output logic        pixel_frame_end,
  output logic        pixel_bad,
  output logic        pixel_test,
  output logic        resumed,    // pixels were dropped before the frame that pixel_frame_end ended last

  output logic [31:0] now,        // cycles since reset
  output logic [31:0] frame_time  // `now` when the first pixel of this frame was taken
);

  logic held_valid, held_ready, held_last, held_user;
  logic [23:0] held_data;
  td_axis_skid #(.Width(26)) u_skid (
    .clk, .rst,
    .s_valid(s_axis_tvalid), .s_ready(s_axis_tready), .s_data({s_axis_tuser, s_axis_tlast, s_axis_tdata}),
    .m_valid(held_valid), .m_ready(held_ready), .m_data({held_user, held_last, held_data})
  );

  logic between, row_ends, frame_ends, tested_valid, tested_ready, tested_last, tested_user, testing;
  logic [23:0] tested_data;
  test_picture u_test (
    .clk, .rst, .request(self_test), .between, .row_ends, .frame_ends,
    .s_valid(held_valid), .s_ready(held_ready), .s_data(held_data), .s_last(held_last), .s_user(held_user),
    .m_valid(tested_valid), .m_ready(tested_ready), .m_data(tested_data), .m_last(tested_last), .m_user(tested_user),
    .m_test(testing)
  );

  faults_t faults_now;  // behind long paths
  frame_guard #(.Rows(Rows), .Columns(Columns)) u_guard (
    .clk, .rst, .en, .timeout,
    .s_valid(tested_valid), .s_ready(tested_ready), .s_data(tested_data), .s_last(tested_last), .s_user(tested_user),
    .s_test(testing), .between, .row_ends, .frame_ends, .out_valid(pixel_valid), .out_data(pixel_data),
    .out_position(pixel_position), .out_frame_start(pixel_frame_start), .out_frame_end(pixel_frame_end),
    .out_bad(pixel_bad), .out_test(pixel_test), .faults(faults_now), .hunting
  );

  logic counts, counts_last, counts_user;  // a pixel that was taken in the cycle before
  always_ff @(posedge clk) {counts, counts_last, counts_user} <= {held_valid & held_ready & ~rst, held_last, held_user};
  td_frame_size #(.CountWidth(14)) u_size (
    .clk, .rst, .in_valid(counts), .in_last(counts_last), .in_user(counts_user),
    .columns(arrived_columns), .rows(arrived_rows), .silent()
  );

  logic taking;  // a frame has begun and not ended
  logic hunted, frame_resumed;  // in the cycle before; of the frame that comes
  logic [31:0] arrival_time;
  assign busy = held_valid | pixel_frame_start | taking;
  always_ff @(posedge clk) begin
    now <= now + 32'd1;
    if (s_axis_tvalid && s_axis_tready && s_axis_tuser) arrival_time <= now;
    faults <= faults_now;
    if (en) hunted <= hunting;
    if (en && pixel_frame_start) {frame_time, frame_resumed} <= {arrival_time, hunted};
    if (en && pixel_frame_end) resumed <= frame_resumed;
    if (en) taking <= (pixel_frame_start | taking) & ~pixel_frame_end;
    if (rst) begin
      {now, faults} <= '0;
      taking <= 1'b0;
    end
  end

endmodule

`default_nettype wire
