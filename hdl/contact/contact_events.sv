// SPDX-License-Identifier: Apache-2.0
// contact_events: what touches the gel, once a frame: a record of the contact, and whether it is one.
//
//   above    = a depth above the threshold in force: on_threshold while not touching, off_threshold while touching
//   touching <- 1 after `debounce` frames in a row with at least minimum_area depths above (debounce 0: as 1)
//   touching <- 0 after `debounce` frames in a row with fewer; it changes between frames only
//   centroid = 16 sum / area, to the nearest, ties to even: 1/16 pixel
//
// A minimum_area of 0 makes every frame one that touches. Settings and in_time are taken with a frame's first depth.
//
// Stream in: depth codes as they leave (valid and ready together), raster order or, BottomFirst, bottom row first; they
// are never held back. Rows are counted from the picture's top either way. Frames come whole; one that begins inside
// another begins afresh. From one frame's last depth to the next one's lie at least Latency clocks, which any frame of
// at least 32 pixels has. Gaps change nothing.
//
// Record: 13 words of 32 bits, word n in bits 32 n + 31 to 32 n, kept until the next; zero after a reset. Of a frame
// with nothing above, words 3 to 12 are zero. Places are {row, column} in 31:16 and 15:0.
//    0 bit 0 touching, 1 it began with this frame, 2 it ended with this frame
//    1 number of the frame, from 1, modulo 2^32   2 in_time   3 area: depths above
//    4 highest depth, signed   5 its place, of equals the first in stream order
//    6, 7 least and greatest row and column of those above   8, 9 sums of their columns and of their rows
//   10, 11 sum of their depths, signed, low word first   12 centroid, {row, column}
//
// Stream out: each record as a packet of 13 words, word 0 first, tlast with word 12. A record that finds the one before
// still waiting for its turn replaces it, and event_lost is high for a clock; what has begun is finished.
// Latency: the record stands in its register Latency = 2 log2(larger side) + 16 clocks after the last depth was taken,
// the packet's first word one clock later, touching 3 clocks after it. Bit-accurate model:
// models/tactile_depth/contact/contact_events.py.

module contact_events #(
  parameter int Width       = 24,
  parameter int Rows        = 128,
  parameter int Columns     = 128,
  parameter int BottomFirst = 0,
  localparam int Words = 13
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    in_valid,
  input  logic                    in_user,       // first depth of a frame
  input  logic                    in_last,       // last depth of a row
  input  logic                    in_frame_end,  // last depth of a frame
  input  logic signed [Width-1:0] in_data,
  input  logic [31:0]             in_time,       // of the frame that begins
  input  logic signed [31:0]      on_threshold,
  input  logic signed [31:0]      off_threshold,
  input  logic [31:0]             minimum_area,  // pixels
  input  logic [7:0]              debounce,      // frames
  output logic                    touching,
  output logic                    record_valid,  // the record is new in this clock
  output logic [32*Words-1:0]     record,
  output logic                    event_lost,    // a record was replaced before it was sent
  output logic [31:0]             m_event_tdata,
  output logic                    m_event_tvalid,
  input  logic                    m_event_tready,
  output logic                    m_event_tlast
);

  localparam int Pixels = Rows * Columns;
  localparam int RowWidth = $clog2(Rows);
  localparam int ColumnWidth = $clog2(Columns);
  localparam int PlaceWidth = RowWidth > ColumnWidth ? RowWidth : ColumnWidth;
  localparam int AreaWidth = $clog2(Pixels + 1);
  localparam int ColumnSumWidth = $clog2(Pixels * (Columns - 1) / 2 + 1);
  localparam int RowSumWidth = $clog2(Pixels * (Rows - 1) / 2 + 1);
  localparam int SumWidth = AreaWidth + PlaceWidth - 1;  // holds both
  localparam int VolumeWidth = Width + $clog2(Pixels);
  localparam int Fraction = 4;
  localparam int Steps = PlaceWidth + Fraction + 1;  // quotient bits of a division, with one to round by
  localparam int StepWidth = $clog2(Steps + 1);
  localparam int Latency = 2 * Steps + 6;
  localparam int Summary = 8;  // words of a record that are kept while centroids are divided

  // Depth: place, and on which side of both thresholds.

  logic [ColumnWidth-1:0] column, next_column, column_q, column_q2;
  logic [RowWidth-1:0] row, next_row, row_q, row_q2;
  assign column = in_user ? '0 : next_column;
  if (BottomFirst != 0) begin : g_up
    assign row = in_user ? RowWidth'(Rows - 1) : next_row;
  end else begin : g_down
    assign row = in_user ? '0 : next_row;
  end

  logic signed [31:0] on_q, off_q;

  // Of the frame that is coming in, and of the last that came in whole.
  logic [31:0] minimum, minimum_closed, begun, begun_closed;
  logic [7:0] frames_needed, frames_needed_closed;

  logic signed [Width-1:0] data_q, data_q2;
  logic above_on, above_off, valid_q, first_q, end_q, valid_q2, first_q2;
  always_ff @(posedge clk) begin
    if (in_valid) begin
      next_column <= in_last ? '0 : column + ColumnWidth'(1);
      if (in_last) next_row <= BottomFirst != 0 ? row - RowWidth'(1) : row + RowWidth'(1);
      else next_row <= row;
      if (in_user) begin
        on_q <= on_threshold;
        off_q <= off_threshold;
        minimum <= minimum_area;
        frames_needed <= debounce;
        begun <= in_time;
      end
      if (in_frame_end) begin
        minimum_closed <= minimum;
        frames_needed_closed <= frames_needed;
        begun_closed <= begun;
      end
    end
    column_q <= column;
    row_q <= row;
    data_q <= in_data;
    above_on <= in_user ? 32'(in_data) > on_threshold : 32'(in_data) > on_q;
    above_off <= in_user ? 32'(in_data) > off_threshold : 32'(in_data) > off_q;
    valid_q <= in_valid;
    first_q <= in_user;
    end_q <= in_frame_end;
    if (rst) valid_q <= 1'b0;
  end

  // Area and event. The frame after may begin in the clock in which the event changes: it counts by the new threshold.

  logic above, above_q, counted, summed;
  logic [AreaWidth-1:0] area, area_closed;
  logic enough, differs, turns, touching_now, began, ended;
  logic [7:0] frames_before;  // in a row, that differ from `touching`
  logic [31:0] frame;
  assign enough = 32'(area) >= minimum_closed;
  assign differs = enough != touching;
  assign turns = differs & (9'(frames_before) + 9'd1 >= 9'(frames_needed_closed));
  assign touching_now = touching ^ (counted & turns);
  assign above = touching_now ? above_off : above_on;
  always_ff @(posedge clk) begin
    if (valid_q) area <= (first_q ? '0 : area) + AreaWidth'(above);
    above_q <= above;
    column_q2 <= column_q;
    row_q2 <= row_q;
    data_q2 <= data_q;
    valid_q2 <= valid_q;
    first_q2 <= first_q;
    counted <= valid_q & end_q;  // area is that of the frame, in this clock
    summed <= counted;  // so are the sums
    touching <= touching_now;
    if (counted) begin
      area_closed <= area;
      began <= turns & ~touching;
      ended <= turns & touching;
      frames_before <= differs & ~turns ? frames_before + 8'd1 : 8'd0;
      frame <= frame + 32'd1;
    end
    if (rst) begin
      valid_q2 <= 1'b0;
      counted <= 1'b0;
      summed <= 1'b0;
      touching <= 1'b0;
      frames_before <= '0;
      frame <= '0;
    end
  end

  // Sums and limits over what is above.

  logic some, fresh;  // there was one above in this frame; this is the first
  logic [ColumnSumWidth-1:0] column_sum;
  logic [RowSumWidth-1:0] row_sum;
  logic signed [VolumeWidth-1:0] volume;
  logic signed [Width-1:0] peak;
  logic [RowWidth-1:0] peak_row, first_row, last_row, least_row, greatest_row;
  logic [ColumnWidth-1:0] peak_column, least_column, greatest_column;
  assign fresh = first_q2 | ~some;
  always_ff @(posedge clk) begin
    if (valid_q2) begin
      some <= above_q | ~fresh;
      if (above_q) begin
        column_sum <= (fresh ? '0 : column_sum) + ColumnSumWidth'(column_q2);
        row_sum <= (fresh ? '0 : row_sum) + RowSumWidth'(row_q2);
        volume <= (fresh ? VolumeWidth'(0) : volume) + VolumeWidth'(data_q2);
        if (fresh || data_q2 > peak) begin
          peak <= data_q2;
          peak_row <= row_q2;
          peak_column <= column_q2;
        end
        if (fresh) first_row <= row_q2;
        last_row <= row_q2;
        if (fresh || column_q2 < least_column) least_column <= column_q2;
        if (fresh || column_q2 > greatest_column) greatest_column <= column_q2;
      end
    end
  end
  assign least_row = BottomFirst != 0 ? last_row : first_row;
  assign greatest_row = BottomFirst != 0 ? first_row : last_row;

  logic some_closed;
  logic [32*Summary-1:0] summary, summary_closed;
  assign summary = {
    64'(volume), 32'(row_sum), 32'(column_sum),
    16'(greatest_row), 16'(greatest_column), 16'(least_row), 16'(least_column),
    16'(peak_row), 16'(peak_column), 32'(peak)
  };
  logic [RowSumWidth-1:0] row_sum_closed;
  assign row_sum_closed = summary_closed[32*5+:RowSumWidth];

  // Centroid: a quotient bit a clock, the column's and then the row's. A sum is less than area 2^PlaceWidth.

  logic dividing, of_row, divided;  // the last clock of a division
  logic [StepWidth-1:0] step;
  logic [SumWidth-1:0] dividend;
  logic [AreaWidth-1:0] remainder;
  logic [AreaWidth:0] shifted, difference;
  logic [PlaceWidth-1:0] digits;
  logic [Steps-1:0] quotient;
  logic fits;
  assign divided = dividing & (step == '0);
  assign dividend = summed ? SumWidth'(column_sum) : SumWidth'(row_sum_closed);
  assign shifted = {remainder, digits[PlaceWidth-1]};
  assign difference = shifted - {1'b0, area_closed};
  assign fits = ~difference[AreaWidth];

  localparam int CentroidWidth = PlaceWidth + Fraction;
  logic signed [Steps:0] rounded;
  logic [CentroidWidth-1:0] centroid, column_centroid;
  logic unused_clipped;
  round_saturate #(.InWidth(Steps + 2), .Drop(2), .OutWidth(Steps + 1)) u_round (
    .in($signed({1'b0, quotient, remainder != '0})), .out(rounded), .clipped(unused_clipped)
  );
  logic [Steps-CentroidWidth:0] unused_centroid;  // no mean of places is larger than the largest
  assign {unused_centroid, centroid} = rounded;

  always_ff @(posedge clk) begin
    if (summed) begin
      summary_closed <= some ? summary : '0;
      some_closed <= some;
    end
    if (summed || divided) begin
      remainder <= AreaWidth'(dividend[SumWidth-1:PlaceWidth]);
      digits <= dividend[PlaceWidth-1:0];
      step <= StepWidth'(Steps);
    end else begin
      remainder <= fits ? difference[AreaWidth-1:0] : shifted[AreaWidth-1:0];
      digits <= digits << 1;
      quotient <= {quotient[Steps-2:0], fits};
      step <= step - StepWidth'(1);
    end
    if (divided) column_centroid <= centroid;
    if (summed) begin
      dividing <= 1'b1;
      of_row <= 1'b0;
    end else if (divided) begin
      dividing <= ~of_row;
      of_row <= 1'b1;
    end
    if (rst) dividing <= 1'b0;
  end

  // Record and packet.

  logic renewed, waiting, send, leaves;
  logic [32*Words-1:0] packet;
  logic [$clog2(Words)-1:0] word;
  assign renewed = divided & of_row;
  assign leaves = m_event_tvalid & m_event_tready;
  assign send = waiting & (~m_event_tvalid | (leaves & m_event_tlast));
  assign m_event_tdata = 32'(packet >> {word, 5'd0});
  assign m_event_tlast = word == ($clog2(Words))'(Words - 1);
  assign event_lost = renewed & waiting & ~send;
  always_ff @(posedge clk) begin
    record_valid <= renewed;
    if (renewed) begin
      record <= {
        some_closed ? {16'(centroid), 16'(column_centroid)} : 32'd0, summary_closed, 32'(area_closed), begun_closed,
        frame, 29'd0, ended, began, touching
      };
    end
    waiting <= renewed | (waiting & ~send);
    if (send) packet <= record;
    if (send) word <= '0;
    else if (leaves) word <= word + ($clog2(Words))'(1);
    m_event_tvalid <= send | (m_event_tvalid & ~(leaves & m_event_tlast));
    if (rst) begin
      record_valid <= 1'b0;
      record <= '0;
      waiting <= 1'b0;
      m_event_tvalid <= 1'b0;
    end
  end

`ifndef SYNTHESIS
  initial begin
    if (Width < 2 || Width > 32) $fatal(1, "%m: Width must be 2 to 32");
    if (Rows < 2 || Rows > 1024) $fatal(1, "%m: Rows must be 2 to 1024");
    if (Columns < 2 || Columns > 1024) $fatal(1, "%m: Columns must be 2 to 1024");
    if (Pixels < Latency) $fatal(1, "%m: a frame must have at least Latency pixels: 32 are enough");
  end
`endif

endmodule
