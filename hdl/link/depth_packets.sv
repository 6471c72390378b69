// SPDX-License-Identifier: Apache-2.0
// depth_packets: sends the frame that waits in depth_store as depth packets and a trailer (docs/link.md), without the
// CRC of each packet.
//
// It takes a frame as soon as it is free, if the format is not 0; format and shift count as they are in that clock.
// Stream out: the bytes of kind and fields. A packet has Values values, the last of a frame the rest. `sent` is the
// number of the last frame that was taken; `sending`: it is not complete yet. A reset gives the frame up; cold_rst,
// which comes with a reset, clears `sent`, which is 0 at power-up. `resets` does not change inside a frame. A byte
// takes a clock; 6 more before each value, 9 if it is a mean, and 1 before a word of the record. Models: Depth and
// Trailer in models/tactile_depth/chip/link/packets.py, to_bytes in models/tactile_depth/chip/link/depth_formats.py.

`default_nettype none

module depth_packets
  import td_link_pkg::*;
  import td_register_map_pkg::RecordWords;
#(
  parameter int Rows        = 128,
  parameter int Columns     = 128,  // a power of two
  parameter int DataWidth   = 24,
  parameter int BottomFirst = 0,
  parameter int Values      = ValuesAPacket,  // a power of two
  localparam int PlaceWidth = $clog2(Rows * Columns)
) (
  input  wire                         clk,
  input  wire                         rst,
  input  wire                         cold_rst,
  input  wire  [1:0]                  format,
  input  wire  [4:0]                  shift,
  input  wire  [15:0]                 resets,
  input  wire                         frame_valid,
  output logic                        frame_take,
  output logic                        frame_done,
  output logic                        value_read,
  output logic [PlaceWidth-1:0]       value_address,
  input  wire  signed [DataWidth-1:0] value_data,     // 3 clocks after value_read
  output logic [3:0]                  record_word,
  input  wire  [31:0]                 record_data,    // 1 clock after record_word
  output logic                        depth_valid,
  input  wire                         depth_ready,
  output logic [7:0]                  depth_data,
  output logic                        depth_last,
  output logic [31:0]                 sent,
  output logic                        sending
);

  localparam int ColumnWidth = $clog2(Columns);
  localparam logic [PlaceWidth-1:0] LastPlace = PlaceWidth'(Rows * Columns - 1);
  localparam logic [PlaceWidth-1:0] InPacket = PlaceWidth'($unsigned(Values - 1));  // the bits that count in a packet
  localparam logic [PlaceWidth-1:0] InRow = PlaceWidth'($unsigned(Columns - 1));
  localparam logic [PlaceWidth-1:0] LastMean = PlaceWidth'((Rows / 2) * (Columns / 2) - 1);
  localparam logic [1:0] LastOfWord = 2'((DataWidth + 7) / 8 - 1);
  localparam logic [5:0] LastOfHeader = 6'd8;
  localparam logic [5:0] LastOfTrailer = 6'd17;
  localparam logic [5:0] LastOfRecord = 6'(4 * RecordWords - 1);
  localparam logic [1:0] Words = 2'd1;
  localparam logic [1:0] Means = 2'd3;

  typedef enum logic [1:0] {
    Head,    // the fields in front of values, or of the record
    Load,    // reads a value
    Value,
    Tail     // the record
  } phase_t;
  phase_t phase, phase_next;
  logic trailer;  // all values are sent
  logic [5:0] at, last_at;  // the byte, or the clock in Load; the last one of the phase, early because much hangs on it
  logic [1:0] kept_format;
  logic [4:0] kept_shift;
  logic [31:0] number = '0;
  logic [31:0] crc;       // of the values up to the byte before the last: the trailer's header leaves before it does
  logic counts;           // the byte `counted` is not in it yet
  logic [7:0] counted;
  logic [PlaceWidth-1:0] place;  // of the next value
  logic means, leaves, part_ends, last_value, packet_full, stale;
  assign means = kept_format == Means;
  assign leaves = depth_valid & depth_ready;
  assign last_value = place == (means ? LastMean : LastPlace);
  assign packet_full = (place & InPacket) == InPacket;

  // Values. A mean takes two columns of two rows. What u_value takes outside of Load is not used.
  logic [15:0] short_value;
  logic [31:0] value;
  logic [PlaceWidth-1:0] row, column;
  assign row = place >> (means ? ColumnWidth - 1 : ColumnWidth);
  assign column = place & (means ? InRow >> 1 : InRow);
  assign value_read = phase == Load & sending & (at == '0 | (means & at < 6'd4));
  assign value_address = ~means ? place
      : (((row << 1) | PlaceWidth'(at[1])) << ColumnWidth) | (column << 1) | PlaceWidth'(at[0]);
  depth_value #(.DataWidth(DataWidth)) u_value (
    .clk, .average(means), .shift(kept_shift), .in_valid(at >= 6'd3 & at <= (means ? 6'd6 : 6'd3)),
    .in_first(at == 6'd3), .in_code(value_data), .value(short_value)
  );
  assign value = kept_format == Words ? 32'(value_data) : {16'd0, short_value};

  // Bytes.
  logic [71:0] header;
  logic [143:0] trailer_fields;
  assign header = {16'(column), 16'(row), number, Depth | 8'(kept_format)};
  assign trailer_fields = {
    ~crc, 8'(BottomFirst), means ? 16'(Columns / 2) : 16'(Columns), means ? 16'(Rows / 2) : 16'(Rows), 8'(kept_shift),
    8'(kept_format), resets, number, Trailer
  };
  logic [1:0] lane;
  assign lane = at[1:0];
  assign record_word = at[5:2];
  always_comb begin
    unique case (phase)
      Head: depth_data = 8'((trailer ? trailer_fields : 144'(header)) >> {at, 3'd0});
      Value: depth_data = 8'(value >> {lane, 3'd0});
      Tail: depth_data = 8'(record_data >> {lane, 3'd0});
      Load: depth_data = '0;
    endcase
    phase_next = Load;
    if (phase == Load) phase_next = Value;
    if (phase == Value && (packet_full || last_value)) phase_next = Head;
    if (trailer) phase_next = Tail;
  end
  assign part_ends = at == last_at;
  assign depth_valid = sending & phase != Load & ~stale;
  assign depth_last = part_ends & (phase == Tail | (phase == Value & (packet_full | last_value)));
  assign frame_take = ~sending & ~frame_done & frame_valid & format != 2'd0;
  assign sent = number;

  always_ff @(posedge clk) begin
    frame_done <= leaves & phase == Tail & part_ends;
    stale <= leaves & (phase == Tail ? lane == '1 : trailer & part_ends);
    if (leaves || phase == Load) begin
      at <= part_ends ? '0 : at + 6'd1;
      if (part_ends) begin
        phase <= phase_next;
        unique case (phase_next)
          Head: last_at <= last_value ? LastOfTrailer : LastOfHeader;
          Load: last_at <= means ? 6'd8 : 6'd5;
          Value: last_at <= kept_format == Words ? 6'(LastOfWord) : 6'd1;
          Tail: last_at <= LastOfRecord;
        endcase
        if (phase == Value) begin
          trailer <= last_value;
          place <= place + PlaceWidth'(1);
        end
        if (phase == Tail) sending <= 1'b0;
      end
    end
    counts <= leaves & phase == Value;
    counted <= depth_data;
    if (counts) crc <= crc32_step(crc, counted);
    if (frame_take) begin
      sending <= 1'b1;
      phase <= Head;
      at <= '0;
      last_at <= LastOfHeader;
      trailer <= 1'b0;
      place <= '0;
      crc <= CrcStart;
      kept_format <= format;
      kept_shift <= format == Words ? '0 : shift;
    end
    if (rst) begin
      sending <= 1'b0;
      frame_done <= 1'b0;
      stale <= 1'b0;
    end
    if (cold_rst) number <= '0;
    else if (frame_take && !rst) number <= number + 32'd1;
  end

endmodule

`default_nettype wire
