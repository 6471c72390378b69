// SPDX-License-Identifier: Apache-2.0
// contact_events: a record of the contact in each frame, and whether something touches.
//
//   depth --> contact_peak --> contact_debounce --> touching
//     |            \-> area threshold
//     \-> delay --> contact_sums --> centroid --> record_packets --> record, m_event
//
//   above = a depth greater than the threshold in force: on_threshold while not touching, off_threshold while touching
//   area threshold of a frame = min(area_threshold, half the peak of the last frame, if one was above then), but never
//   below the threshold in force; and a depth code
//
// Stream in: depth codes as they leave (valid and ready together), Lanes of them in a beat, raster order or,
// BottomFirst, bottom row first; they are never held back, and gaps change nothing. A frame that begins inside another
// begins afresh. Settings and in_time are taken with a frame's first beat, in_flags with its last. From the last beat
// of a frame to that of the next lie at least Latency cycles. in_flipped and in_residual are taken as a
// record enters its register. Stream out: the record of each frame, docs/generated/registers.md, as a packet. Latency:
// the record is in its register, until the next, Latency = 2 log2(larger side) + 2 log2(Lanes) + 22 cycles after the
// last beat, touching 3 cycles after it. Bit-accurate model: models/tactile_depth/chip/contact/contact_events.py.

`default_nettype none

module contact_events
  import td_types_pkg::*;
#(
  parameter int Width       = 24,
  parameter int Rows        = 128,
  parameter int Columns     = 128,
  parameter int Lanes       = 1,  // depths in a beat
  parameter int BottomFirst = 0,  // 1: the bottom row comes first
  parameter int Parity      = 0,  // 1: a parity bit in each word of the delay
  localparam int Words = td_register_map_pkg::RecordWords
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     in_valid,
  input  wire depth_position_t    in_position,
  input  wire  [Lanes*Width-1:0]  in_data,         // depth codes, signed
  input  wire  [Lanes-1:0]        in_above,        // depths of the beat above the frame's on_threshold
  input  wire  [31:0]             in_time,         // of the frame that begins, cycles
  input  wire frame_flags_t       in_flags,        // of the frame that ends, without those below
  input  wire                     in_flipped,      // the record is of a frame that a flipped bit may have damaged
  input  wire  signed [Width:0]   on_threshold,    // depth code, or one beyond them
  input  wire  signed [Width:0]   off_threshold,   // the same
  input  wire  signed [Width:0]   area_threshold,  // the same
  input  wire  [31:0]             minimum_area,    // pixels above
  input  wire  [7:0]              debounce,        // frames
  input  wire                     in_residual,     // the residual of the frame of the record is beyond its bound
  output logic                    flipped,         // a word that was read has a flipped bit
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
  localparam int CountWidth = $clog2(Rows * Columns + 1);
  localparam int WeightWidth = Width + $clog2(Rows * Columns);
  localparam int MomentWidth = WeightWidth + PositionWidth;
  localparam int Delay = $clog2(Lanes) + 6;  // until the first beat of a frame finds the area threshold
  localparam int PositionBits = $bits(depth_position_t);

  // Settings and time: of the frame that comes in (_q: since its first beat), and of the last frame (last_).

  logic signed [Width:0] on_q, off, off_q, area_limit;
  logic [31:0] minimum, last_minimum, start_time, last_time, frame;
  logic [7:0] frames_needed, last_frames_needed;
  assign off = in_position.frame_start ? off_threshold : off_q;

  frame_flags_t last_flags, record_flags;
  logic touching_next, count_valid, peak_valid, any_above, last_any, began, ended;
  logic [CountWidth-1:0] count;
  logic signed [Width-1:0] peak, last_peak;
  logic [15:0] peak_row, peak_column, last_peak_row, last_peak_column;
  contact_peak #(
    .Width(Width), .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .BottomFirst(BottomFirst)
  ) u_peak (
    .clk, .rst, .in_valid, .in_position, .in_data, .in_above, .off_threshold(off), .touching(touching_next),
    .count_valid, .count, .peak_valid, .any_above, .peak, .peak_row, .peak_column
  );
  contact_debounce #(.AreaWidth(CountWidth)) u_debounce (
    .clk, .rst, .area_valid(count_valid), .area(count), .minimum_area(last_minimum), .debounce(last_frames_needed),
    .touching_next, .touching, .began, .ended
  );

  // Area threshold. The delayed frame takes it Delay cycles after its first beat, when the peak of the last is known.

  logic signed [Width:0] in_force, half_peak, wanted, least_wanted;  // a register behind each choice
  logic signed [Width-1:0] level, level_of_frame, last_level;
  assign half_peak = (Width + 1)'(last_peak >>> 1);
  always_ff @(posedge clk) begin
    in_force <= touching ? off_q : on_q;
    wanted <= last_any && half_peak < area_limit ? half_peak : area_limit;
    least_wanted <= wanted > in_force ? wanted : in_force;
    level <= least_wanted[Width-1:0];
    if (least_wanted[Width] != least_wanted[Width-1]) begin
      level <= {least_wanted[Width], {(Width - 1) {~least_wanted[Width]}}};
    end
  end

  logic [Delay-1:0] valid_delayed;
  depth_position_t late_position;
  logic [Lanes*Width-1:0] late_data;
  logic late_valid, sums_valid, sums_held;
  contact_sums_t sums;
  td_delay_line #(.Width(PositionBits + Lanes * Width), .Delay(Delay), .Parity(Parity)) u_delay (
    .clk, .rst, .en(1'b1), .in({in_position, in_data}), .out({late_position, late_data}), .flipped
  );
  assign late_valid = valid_delayed[Delay-1];
  contact_sums #(
    .Width(Width), .Rows(Rows), .Columns(Columns), .Lanes(Lanes), .BottomFirst(BottomFirst)
  ) u_sums (
    .clk, .rst, .in_valid(late_valid), .in_position(late_position), .in_data(late_data), .threshold(level),
    .sums_valid, .sums
  );

  // Centroid. The moments count from the last row to come and from the last column; without area it is the peak.

  localparam logic [15:0] LastRow = 16'(16 * (Rows - 1));  // in units of 1/16 pixel
  localparam logic [15:0] LastColumn = 16'(16 * (Columns - 1));

  logic centroid_valid, no_area;
  logic [PositionWidth+3:0] mean_column, mean_row;
  logic [31:0] middle, least, last_least, greatest, last_greatest, peak_position;
  centroid #(.PositionWidth(PositionWidth), .WeightWidth(WeightWidth)) u_centroid (
    .clk, .rst, .start(sums_held), .column_moment(MomentWidth'(sums.column_moment)),
    .row_moment(MomentWidth'(sums.row_moment)), .weight(WeightWidth'(sums.weight)), .done(centroid_valid),
    .column(mean_column), .row(mean_row)
  );
  assign no_area = sums.area == '0;
  assign peak_position = {last_peak_row, last_peak_column};
  assign middle = no_area ? peak_position << 4
      : {BottomFirst != 0 ? 16'(mean_row) : LastRow - 16'(mean_row), LastColumn - 16'(mean_column)};
  assign least = no_area ? peak_position : last_least;
  assign greatest = no_area ? peak_position : last_greatest;

  always_comb begin
    record_flags = last_flags;
    record_flags.flipped = in_flipped;
    record_flags.residual = in_residual;
  end
  record_packets #(.Words(Words)) u_packets (
    .clk, .rst, .new_valid(centroid_valid),
    .new_record({record_flags, middle, sums.weight, greatest, least, sums.area, 32'(last_level), peak_position,
      32'(last_peak), last_time, frame, 29'd0, ended, began, touching}),
    .record_valid, .record, .record_lost, .m_event_tdata, .m_event_tvalid, .m_event_tready, .m_event_tlast
  );

  always_ff @(posedge clk) begin
    if (in_valid && in_position.frame_start) begin
      on_q <= on_threshold;
      off_q <= off;
      area_limit <= area_threshold;
      minimum <= minimum_area;
      frames_needed <= debounce;
      start_time <= in_time;
    end
    if (in_valid && in_position.frame_end) begin
      last_minimum <= minimum;
      last_frames_needed <= frames_needed;
      last_time <= start_time;
      last_flags <= in_flags;
    end
    if (count_valid) frame <= frame + 32'd1;
    if (peak_valid) begin
      {last_any, last_peak} <= {any_above, peak};
      {last_peak_row, last_peak_column} <= {peak_row, peak_column};
    end
    valid_delayed <= Delay'({valid_delayed, in_valid});
    if (late_valid && late_position.frame_start) level_of_frame <= level;
    if (late_valid && late_position.frame_end) last_level <= level_of_frame;
    if (sums_valid) begin
      last_least <= {sums.least_row, sums.least_column};
      last_greatest <= {sums.greatest_row, sums.greatest_column};
    end
    sums_held <= sums_valid;
    if (rst) {frame, last_any, sums_held, valid_delayed} <= '0;
  end

endmodule

`default_nettype wire
