// SPDX-License-Identifier: Apache-2.0
// serial_link: a serial line's bytes to pixels and register writes, records of contacts back.
//
// Packets, both ways, are framed as in RFC 1055 (SLIP): End (C0) closes a packet and may stand before one too; within,
// C0 is sent as DB DC and DB as DB DD. The first byte in says what follows, words have their low byte first:
//   1  a frame: red, green, blue of each pixel, raster order      2  a register write: address / 4, word of 32 bits
// Out: each packet of words on s_event as one packet of bytes. After a reset `threshold` is written to THRESHOLD and
// OFF_THRESHOLD by itself. What is neither is dropped up to the next End, and so is what follows a broken byte; a frame
// that lacks bytes leaves as it is, and frame_guard drops it. Pixels wait here while the guard fills such a one up.
// Model: models/tactile_depth/boards/serial_link.py.

`default_nettype none

module serial_link
  import td_register_map_pkg::*;
#(
  parameter int Rows    = 128,
  parameter int Columns = 128,
  parameter int Divider = 33  // clocks a bit on the line
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire  [31:0]             threshold,

  input  wire                     in_valid,
  input  wire  [7:0]              in_data,
  input  wire                     in_broken,
  output logic                    out_valid,
  input  wire                     out_ready,
  output logic [7:0]              out_data,

  output logic [23:0]             m_axis_tdata,
  output logic                    m_axis_tvalid,
  input  wire                     m_axis_tready,
  output logic                    m_axis_tlast,
  output logic                    m_axis_tuser,

  input  wire  [31:0]             s_event_tdata,
  input  wire                     s_event_tvalid,
  output logic                    s_event_tready,
  input  wire                     s_event_tlast,

  output logic [AddressWidth-1:0] m_axil_awaddr,
  output logic                    m_axil_awvalid,
  input  wire                     m_axil_awready,
  output logic [31:0]             m_axil_wdata,
  output logic                    m_axil_wvalid,
  input  wire                     m_axil_wready
);

  localparam logic [7:0] End = 8'hC0;
  localparam logic [7:0] Escape = 8'hDB;
  localparam logic [7:0] EscapedEnd = 8'hDC;
  localparam logic [7:0] EscapedEscape = 8'hDD;
  localparam logic [7:0] FramePacket = 8'd1;
  localparam logic [7:0] WritePacket = 8'd2;

  // Bytes in: escapes taken out, the first of a packet read.

  typedef enum logic [1:0] {Dropping, Kind, Frame, Write} state_e;
  state_e state;
  logic escaped, closes, opens, escapes, given, bad;
  logic [7:0] value;
  assign closes = in_valid & (in_data == End);
  assign escapes = in_valid & ~escaped & (in_data == Escape);
  assign bad = in_broken | (in_valid & escaped & (in_data != EscapedEnd) & (in_data != EscapedEscape));
  assign given = in_valid & ~closes & ~escapes;
  assign value = !escaped ? in_data : in_data == EscapedEnd ? End : Escape;
  assign opens = given & (state == Kind);

  always_ff @(posedge clk) begin
    if (in_valid) escaped <= escapes;
    if (closes) begin
      state <= Kind;
    end else if (bad) begin
      state <= Dropping;
    end else if (opens) begin
      case (value)
        FramePacket: state <= Frame;
        WritePacket: state <= Write;
        default: state <= Dropping;
      endcase
    end
    if (rst) begin
      escaped <= 1'b0;
      state <= Dropping;
    end
  end

  // Pixels, through a memory that holds as many as can come while the guard fills up a frame, and a few.

  localparam int BitsAPixel = 30;
  localparam int PlaceWidth = $clog2(Rows * Columns / (BitsAPixel * Divider) + 4);
  localparam int ColumnWidth = $clog2(Columns);

  logic [1:0] colour;  // that comes next
  logic [15:0] red_green;
  logic [ColumnWidth-1:0] column;
  logic first, pixel, fetch;
  logic [PlaceWidth-1:0] head, tail;
  logic [25:0] fetched;
  assign pixel = given & ~bad & (state == Frame) & (colour == 2'd2);
  assign fetch = (head != tail) & (m_axis_tready | ~m_axis_tvalid);
  assign {m_axis_tuser, m_axis_tlast, m_axis_tdata} = fetched;

  always_ff @(posedge clk) begin
    if (opens) begin
      colour <= '0;
      column <= '0;
      first <= 1'b1;
    end else if (given) begin
      colour <= colour == 2'd2 ? '0 : colour + 2'd1;
      red_green <= {red_green[7:0], value};
      if (pixel) begin
        first <= 1'b0;
        column <= column == ColumnWidth'(Columns - 1) ? '0 : column + ColumnWidth'(1);
      end
    end
    if (pixel && head + PlaceWidth'(1) != tail) head <= head + PlaceWidth'(1);
    if (fetch) tail <= tail + PlaceWidth'(1);
    m_axis_tvalid <= fetch | (m_axis_tvalid & ~m_axis_tready);
    if (rst) begin
      head <= '0;
      tail <= '0;
      m_axis_tvalid <= 1'b0;
    end
  end

  td_ram #(.Width(26), .Depth(1 << PlaceWidth), .Style(0)) u_waiting (
    .clk, .write_en(pixel), .write_address(head),
    .write_data({first, column == ColumnWidth'(Columns - 1), red_green[15:8], value, red_green[7:0]}),
    .read_en(fetch), .read_address(tail), .read_data(fetched)
  );

  // Register writes: a packet's when it closes with the right length, before them those of the threshold.

  localparam logic [2:0] WriteBytes = 3'd5;
  logic [1:0] initial_writes;  // done
  logic [2:0] count;
  logic [39:0] write;  // word, address / 4
  logic idle, starting;
  assign idle = ~m_axil_awvalid & ~m_axil_wvalid;
  assign starting = initial_writes != 2'd2;

  always_ff @(posedge clk) begin
    if (opens) begin
      count <= '0;
    end else if (given) begin
      if (count <= WriteBytes) count <= count + 3'd1;
      write <= {value, write[39:8]};
    end
    if (m_axil_awready) m_axil_awvalid <= 1'b0;
    if (m_axil_wready) m_axil_wvalid <= 1'b0;
    if (idle && (starting || (closes && state == Write && count == WriteBytes))) begin
      m_axil_awvalid <= 1'b1;
      m_axil_wvalid <= 1'b1;
      if (starting) begin
        m_axil_awaddr <= initial_writes[0] ? AddressWidth'(OffThresholdOffset) : AddressWidth'(ThresholdOffset);
        m_axil_wdata <= threshold;
        initial_writes <= initial_writes + 2'd1;
      end else begin
        m_axil_awaddr <= AddressWidth'({write[7:0], 2'b00});
        m_axil_wdata <= write[39:8];
      end
    end
    if (rst) begin
      initial_writes <= '0;
      m_axil_awvalid <= 1'b0;
      m_axil_wvalid <= 1'b0;
    end
  end

  // Records out.

  logic [31:0] word;
  logic [2:0] bytes;  // of the word, still to go
  logic replying, ending, escaping, free;
  assign free = out_ready | ~out_valid;
  assign s_event_tready = free & replying & (bytes == '0) & ~ending;

  always_ff @(posedge clk) begin
    if (free) begin
      out_valid <= 1'b0;
      if (bytes != '0) begin
        out_valid <= 1'b1;
        escaping <= ~escaping & (word[7:0] == End || word[7:0] == Escape);
        if (!escaping && (word[7:0] == End || word[7:0] == Escape)) begin
          out_data <= Escape;
        end else begin
          out_data <= !escaping ? word[7:0] : word[7:0] == End ? EscapedEnd : EscapedEscape;
          word <= {8'd0, word[31:8]};
          bytes <= bytes - 3'd1;
        end
      end else if (ending || (!replying && s_event_tvalid)) begin
        out_valid <= 1'b1;
        out_data <= End;
        ending <= 1'b0;
        replying <= ~ending;
      end else if (replying && s_event_tvalid) begin
        word <= s_event_tdata;
        bytes <= 3'd4;
        ending <= s_event_tlast;
      end
    end
    if (rst) begin
      out_valid <= 1'b0;
      bytes <= '0;
      replying <= 1'b0;
      ending <= 1'b0;
      escaping <= 1'b0;
    end
  end

endmodule

`default_nettype wire
