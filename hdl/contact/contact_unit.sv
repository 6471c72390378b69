// SPDX-License-Identifier: Apache-2.0
// contact_unit: depth out, `contact`, and a record of each frame's contact.
//
//   depth --> depth_gate --> m_axis
//                 \-> threshold_comparator --> contact
//                 |              |
//                 |              v above
//                 \-------> contact_events --> m_event, record
//                                ^
//    flipped bits -> flip_marks
//
// Stream in: depth codes of whole frames, Lanes neighbours in a beat, under the enable, which this unit makes: low
// while the output is full. Streams out: AXI4-Stream, each depth sign-extended to whole bytes, the first in the lowest
// bits; a packet of words for each frame. Latency: 1 cycle to m_axis, 2 to contact.
// Models: models/tactile_depth/chip/contact/depth_gate.py, models/tactile_depth/chip/contact/.

`default_nettype none

module contact_unit
  import td_config_pkg::*;
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter logic [ConfigBits-1:0] Config = DefaultConfig,
  localparam int Rows        = value(Config, RowsField),
  localparam int Columns     = value(Config, ColumnsField),
  localparam int DataWidth   = value(Config, DataWidthField),
  localparam int Lanes       = value(Config, LanesField),  // depths in a beat
  localparam int Tridiagonal = value(Config, TridiagonalField),  // 1: the bottom row comes first
  localparam int FrameLatency = value(Config, FrameLatencyField),
  localparam int Parity      = value(Config, ParityField),  // of the memories
  localparam int DepthBits = 8 * ((DataWidth + 7) / 8)  // of a depth on m_axis
) (
  input  wire                         clk,
  input  wire                         rst,
  output logic                        en_next,  // whether the whole pipeline moves in the next clock

  input  wire contact_settings_t      settings,
  input  wire  [31:0]                 now,
  output logic                        frame_leaves,         // its last depth value does
  output logic                        depth_dropped,        // a frame was given up
  output logic                        stalled,              // the sink holds the pipeline up, or has cost a frame
  output logic                        record_valid,         // the record is new in this cycle
  output logic                        record_lost,
  output logic                        flip_found,           // such a word was read, and counts
  output logic                        residual_found,       // with record_valid: that of its frame is beyond
  output logic                        touching,
  output logic [32*RecordWords-1:0]   record,               // of the last frame
  output logic [31:0]                 first_depth_latency,  // from a frame's first pixel to its first depth value
  output logic                        first_depth_latency_valid,

  input  wire                         depth_valid,
  input  wire depth_position_t        depth_position,
  input  wire  [Lanes*DataWidth-1:0]  depth_data,  // depth codes, signed
  input  wire  [31:0]                 depth_time,
  input  wire frame_flags_t           depth_flags,  // counts with the last beat of a frame
  input  wire  [2:0]                  flipped,      // a flipped bit is seen
  input  wire                         beyond,       // the residual of the last frame is beyond its bound

  output logic [Lanes*DepthBits-1:0]  m_axis_tdata,  // the same, each sign-extended to whole bytes
  output logic                        m_axis_tvalid,
  input  wire                         m_axis_tready,
  output logic                        m_axis_tlast,
  output logic                        m_axis_tuser,

  output logic                        contact,

  output logic [31:0]                 m_event_tdata,
  output logic                        m_event_tvalid,
  input  wire                         m_event_tready,
  output logic                        m_event_tlast
);

  logic en, tap_valid;
  depth_position_t m_position, tap_position;
  logic [Lanes*DataWidth-1:0] m_data, tap_data;
  depth_gate #(.Width(Lanes * DataWidth)) u_gate (
    .clk, .rst, .drop_frames(settings.drop_frames), .en, .en_next, .in_valid(depth_valid),
    .in_position(depth_position), .in_data(depth_data), .event_dropped(depth_dropped), .stalled,
    .m_valid(m_axis_tvalid), .m_ready(m_axis_tready), .m_position, .m_data, .tap_valid, .tap_position, .tap_data
  );
  assign m_axis_tuser = m_position.frame_start;
  assign m_axis_tlast = m_position.row_end;
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    logic signed [DataWidth-1:0] depth;
    assign depth = m_data[lane*DataWidth+:DataWidth];
    assign m_axis_tdata[lane*DepthBits+:DepthBits] = DepthBits'(depth);
  end
  assign frame_leaves = m_axis_tvalid & m_axis_tready & m_position.frame_end;

  // A change of a threshold counts a clock later.

  logic signed [DataWidth:0] on_threshold, off_threshold, area_threshold;
  always_ff @(posedge clk) begin
    on_threshold <= (DataWidth + 1)'(near_depths(settings.threshold, DataWidth));
    off_threshold <= (DataWidth + 1)'(near_depths(settings.off_threshold, DataWidth));
    area_threshold <= (DataWidth + 1)'(near_depths(settings.area_threshold, DataWidth));
  end

  logic [Lanes-1:0] tap_above;
  threshold_comparator #(.Width(DataWidth), .Lanes(Lanes)) u_comparator (
    .clk, .rst, .in_valid(tap_valid), .in_frame_start(tap_position.frame_start), .in_data(tap_data),
    .threshold(on_threshold), .hold(settings.hold_contact), .above(tap_above), .contact
  );

  logic [31:0] tap_time;
  frame_flags_t tap_flags;
  logic record_marked, events_flipped;
  contact_events #(
    .Width(DataWidth), .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .BottomFirst(Tridiagonal), .Parity(Parity)
  ) u_events (
    .clk, .rst, .in_valid(tap_valid), .in_position(tap_position), .in_data(tap_data), .in_above(tap_above),
    .in_time(tap_time), .in_flags(tap_flags), .in_flipped(record_marked), .in_residual(beyond),
    .flipped(events_flipped), .on_threshold, .off_threshold, .area_threshold, .minimum_area(settings.minimum_area),
    .debounce(settings.debounce), .touching, .record_valid, .record, .record_lost, .m_event_tdata, .m_event_tvalid,
    .m_event_tready, .m_event_tlast
  );

  // A frame leaves its record at most InFlight records after a clock in which any part of it was in a memory.

  localparam int Pixels = Rows * Columns;
  localparam int InFlight = (FrameLatency + Pixels / Lanes + 128) / Pixels + 2;
  assign residual_found = record_valid & beyond;
  logic any_flipped;
  always_ff @(posedge clk) any_flipped <= events_flipped || flipped != '0;
  flip_marks #(.Records(InFlight)) u_flips (
    .clk, .rst, .flipped(any_flipped), .record_valid, .marked(record_marked), .found(flip_found)
  );

  // A frame that is dropped outputs no first depth value, so its time is not waited for.

  logic depth_starts, awaited;
  logic [31:0] awaited_time;
  assign depth_starts = en & depth_valid & depth_position.frame_start;
  assign first_depth_latency = now - awaited_time;
  assign first_depth_latency_valid = awaited & m_axis_tvalid & m_axis_tuser;
  always_ff @(posedge clk) begin
    if (depth_starts) tap_time <= depth_time;
    if (en && depth_valid && depth_position.frame_end) tap_flags <= depth_flags;
    if (first_depth_latency_valid) awaited <= 1'b0;
    if (depth_starts && !depth_dropped) begin
      awaited_time <= depth_time;
      awaited <= 1'b1;
    end
    if (rst) awaited <= 1'b0;
  end

endmodule

`default_nettype wire
