// SPDX-License-Identifier: Apache-2.0
// contact_events: a record of the contact in each frame, and whether something touches.
//
//   contact_sums --> contact_debounce --> touching
//        \-> centroid --> record_packets --> record, m_event
//
// Stream in: depth codes as they leave (valid and ready together), Lanes of them in a beat, raster order or,
// BottomFirst, bottom row first; they are never held back, and gaps change nothing. A frame that begins inside another
// begins afresh. Settings and in_time are taken with a frame's first beat. From the last beat of a frame to that of the
// next lie at least Latency cycles. Stream out: the record of each frame, docs/registers.md, as a packet. Latency: the
// record is in its register, until the next, Latency = 2 log2(larger side) + 16 + log2(Lanes) cycles after the last
// beat, touching 3 cycles after it. Bit-accurate model: models/tactile_depth/contact/contact_events.py.

`default_nettype none

module contact_events
  import td_types_pkg::*;
#(
  parameter int Width       = 24,
  parameter int Rows        = 128,
  parameter int Columns     = 128,
  parameter int Lanes       = 1,  // depths in a beat
  parameter int BottomFirst = 0,  // 1: the bottom row comes first
  localparam int Words = 13
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     in_valid,
  input  wire depth_position_t    in_position,
  input  wire  [Lanes*Width-1:0]  in_data,         // depth codes, signed
  input  wire  [31:0]             in_time,         // of the frame that begins, cycles
  input  wire  signed [31:0]      on_threshold,    // depth code
  input  wire  signed [31:0]      off_threshold,   // depth code
  input  wire  [31:0]             minimum_area,    // pixels
  input  wire  [7:0]              debounce,        // frames
  output logic                    touching,
  output logic                    record_valid,    // the record is new in this cycle
  output logic [32*Words-1:0]     record,
  output logic                    record_lost,     // a record was replaced before it was sent
  output logic [31:0]             m_event_tdata,
  output logic                    m_event_tvalid,
  input  wire                     m_event_tready,
  output logic                    m_event_tlast
);

  localparam int PositionWidth = $clog2(Rows > Columns ? Rows : Columns);
  localparam int AreaWidth = $clog2(Rows * Columns + 1);
  localparam int SumWidth = AreaWidth + PositionWidth - 1;
  localparam int Latency = 2 * PositionWidth + 16 + $clog2(Lanes);

  logic touching_next, area_valid, sums_valid, began, ended;
  logic [AreaWidth-1:0] area, area_q;
  contact_sums_t sums, sums_q;  // sums_q: of the last frame
  contact_sums #(
    .Width(Width), .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .BottomFirst(BottomFirst)
  ) u_sums (
    .clk, .rst, .in_valid, .in_position, .in_data, .on_threshold, .off_threshold, .touching(touching_next),
    .area_valid, .area, .sums_valid, .sums
  );

  // Settings and time: of the frame that comes in, and of the last frame (_q).

  logic [31:0] minimum, minimum_q, start_time, start_time_q, frame;
  logic [7:0] frames_needed, frames_needed_q;
  contact_debounce #(.AreaWidth(AreaWidth)) u_debounce (
    .clk, .rst, .area_valid, .area, .minimum_area(minimum_q), .debounce(frames_needed_q),
    .touching_next, .touching, .began, .ended
  );

  logic centroid_valid;
  logic [PositionWidth+3:0] mean_column, mean_row;
  logic [31:0] mean_position;
  centroid #(.PositionWidth(PositionWidth), .AreaWidth(AreaWidth)) u_centroid (
    .clk, .rst, .start(sums_valid), .column_sum(SumWidth'(sums.column_sum)), .row_sum(SumWidth'(sums_q.row_sum)),
    .area(area_q), .done(centroid_valid), .column(mean_column), .row(mean_row)
  );
  assign mean_position = area_q == '0 ? '0 : {16'(mean_row), 16'(mean_column)};

  record_packets #(.Words(Words)) u_packets (
    .clk, .rst, .new_valid(centroid_valid),
    .new_record({mean_position, sums_q, 32'(area_q), start_time_q, frame, 29'd0, ended, began, touching}),
    .record_valid, .record, .record_lost, .m_event_tdata, .m_event_tvalid, .m_event_tready, .m_event_tlast
  );

  always_ff @(posedge clk) begin
    if (in_valid && in_position.frame_start) begin
      minimum <= minimum_area;
      frames_needed <= debounce;
      start_time <= in_time;
    end
    if (in_valid && in_position.frame_end) begin
      minimum_q <= minimum;
      frames_needed_q <= frames_needed;
      start_time_q <= start_time;
    end
    if (area_valid) begin
      area_q <= area;
      frame <= frame + 32'd1;
    end
    if (sums_valid) sums_q <= sums;
    if (rst) frame <= '0;
  end

  if (Rows * Columns < Latency) begin : g_refused
    a_frame_must_take_at_least_Latency_cycles u_refused ();
  end

endmodule

`default_nettype wire
