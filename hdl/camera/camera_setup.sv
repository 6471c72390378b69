// SPDX-License-Identifier: Apache-2.0
// camera_setup: writes registers into a camera over SCCB, reads each back, and drives the camera's other pins.
//
// camera.hex has the list, an entry in a word {kind[1:0], address[15:0], data[7:0]}, by
// models/tactile_depth/chip/camera/register_lists.py:
//   0  write the register `address`, read it back, compare      2  read, and compare with data: the product ID
//   1  write it; it does not read back what was written         3  {power_down, reset_n} = address[1:0], then data ms
// A comparison that fails repeats its entry, Attempts times in all; then the list ends with `failed`, and `entry` and
// `found` say where it ended and what was read. With the last entry comes `done`. A reset or `restart` begins afresh.
//
// SCCB: start, bytes of eight bits and a ninth that nobody looks at, stop; a bit takes 4 QuarterClocks. A read is two
// transmissions, one that puts the address and one that reads. sio_d is pulled low or released, never driven high.
// Model: models/tactile_depth/chip/camera/camera_setup.py.

`default_nettype none

module camera_setup #(
  parameter TableFolder = "./",             // of the .hex files, with a / at its end
  parameter int Entries           = 16,
  parameter int AddressBytes      = 1,      // of a register: 1 or 2
  parameter int DeviceId          = 66,     // of a write; a read has the lowest bit set
  parameter int QuarterClocks     = 250,
  parameter int MillisecondClocks = 100000,
  parameter int XclkHalfClocks    = 2,
  parameter int Attempts          = 4,
  localparam int EntryWidth = $clog2(Entries)
) (
  input  wire                   clk,
  input  wire                   rst,
  input  wire                   restart,

  output logic                  xclk,
  output logic                  power_down,
  output logic                  reset_n,
  output logic                  sio_c,
  output logic                  sio_d_low,
  input  wire                   sio_d,

  output logic                  done,
  output logic                  failed,
  output logic [EntryWidth-1:0] entry,
  output logic [7:0]            found
);

  typedef enum logic [1:0] {VerifiedWrite, PlainWrite, Comparison, Pins} kind_e;
  typedef enum logic [1:0] {Write, PutAddress, ReadBack} step_e;
  localparam logic [7:0] WriteId = 8'(DeviceId), ReadId = 8'(DeviceId + 1);
  localparam int AddressBits = 9 * AddressBytes;
  localparam int LongestBits = 18 + AddressBits;  // of a transmission, without start and stop
  localparam int SymbolWidth = $clog2(LongestBits + 2);
  localparam int QuarterWidth = $clog2(QuarterClocks);
  localparam int MillisecondWidth = $clog2(MillisecondClocks);
  localparam int AttemptWidth = $clog2(Attempts + 1);
  localparam int XclkWidth = $clog2(XclkHalfClocks + 1);

  // The list.

  logic [25:0] word;
  kind_e kind;
  logic [15:0] address;
  logic [7:0] data;
  assign {kind, address, data} = word;
  td_rom #(.Width(26), .Depth(Entries), .File({TableFolder, "camera.hex"})) u_list (
    .clk, .en(1'b1), .address(entry), .data(word)
  );

  // Transmissions. A symbol is a start, a bit, or a stop, of four quarters; a released bit is a 1.

  logic sending, quarter_ends, stops, sent;
  logic [QuarterWidth-1:0] clocks;
  logic [1:0] quarter;
  logic [SymbolWidth-1:0] symbol, stop_symbol;
  logic [LongestBits-1:0] bits;  // the next on top
  logic [8:0] caught;            // bits on the line, the last of them lowest
  logic [1:0] line_q;            // two registers for the crossing into this clock
  assign sent = quarter_ends & quarter == 2'd3 & stops;  // of symbols and quarters that have stood for clocks

  logic load;
  step_e step, load_step;
  logic [AddressBits-1:0] address_bits;
  assign address_bits = AddressBits'({address[15:8], 1'b1, address[7:0], 1'b1});

  always_ff @(posedge clk) begin
    line_q <= {line_q[0], sio_d};
    quarter_ends <= sending & ~load & clocks == QuarterWidth'(1);
    stops <= symbol == stop_symbol;
    sio_c <= 1'b1;
    sio_d_low <= 1'b0;
    if (sending) begin
      if (symbol == '0) begin
        sio_c <= ~quarter[1];
        sio_d_low <= quarter != 2'd0;
      end else if (symbol == stop_symbol) begin
        sio_c <= quarter != 2'd0;
        sio_d_low <= ~quarter[1];
      end else begin
        sio_c <= quarter[1] ^ quarter[0];
        sio_d_low <= ~bits[LongestBits-1];
      end
      clocks <= quarter_ends ? QuarterWidth'(QuarterClocks - 1) : clocks - QuarterWidth'(1);
      if (quarter_ends) begin
        quarter <= quarter + 2'd1;
        if (quarter == 2'd2 && symbol != stop_symbol) caught <= {caught[7:0], line_q[1]};
        if (quarter == 2'd3) begin
          symbol <= symbol + SymbolWidth'(1);
          if (symbol != '0) bits <= {bits[LongestBits-2:0], 1'b1};
          if (sent) sending <= 1'b0;
        end
      end
    end
    if (load) begin
      sending <= 1'b1;
      clocks <= QuarterWidth'(QuarterClocks - 1);
      quarter <= '0;
      symbol <= '0;
      step <= load_step;
      case (load_step)
        Write: bits <= {WriteId, 1'b1, address_bits, data, 1'b1};
        PutAddress: bits <= {WriteId, 1'b1, address_bits, 9'd511};
        ReadBack: bits <= {ReadId, 1'b1, {(LongestBits - 9) {1'b1}}};
        default: ;
      endcase
      case (load_step)  // behind the start and the bits
        Write: stop_symbol <= SymbolWidth'(19 + AddressBits);
        PutAddress: stop_symbol <= SymbolWidth'(10 + AddressBits);
        ReadBack: stop_symbol <= SymbolWidth'(19);
        default: ;
      endcase
    end
    if (rst || restart) {sending, quarter_ends} <= '0;
  end

  // Entries, one after the other.

  typedef enum logic [2:0] {Fetch, Decode, Wait, Send, Done, Failed} state_e;
  state_e state;
  logic [AttemptWidth-1:0] attempt;
  logic [MillisecondWidth-1:0] fraction;
  logic [7:0] milliseconds;
  logic differs, advance;
  always_ff @(posedge clk) differs <= caught[8:1] != data;
  assign done = state == Done;
  assign failed = state == Failed;

  always_comb begin
    load = 1'b0;
    load_step = Write;
    advance = 1'b0;
    if (state == Decode) begin
      load = kind != Pins;
      if (kind == Comparison) load_step = PutAddress;
    end else if (state == Wait) begin
      advance = milliseconds == '0;
    end else if (state == Send && sent) begin
      load = step == PutAddress || (step == Write && kind == VerifiedWrite);
      if (step == Write) load_step = PutAddress;
      else load_step = ReadBack;
      advance = step == ReadBack ? ~differs : step == Write && kind == PlainWrite;
    end
  end

  always_ff @(posedge clk) begin
    case (state)
      Fetch: state <= Decode;
      Decode: begin
        state <= kind == Pins ? Wait : Send;
        if (kind == Pins) {power_down, reset_n} <= address[1:0];
        milliseconds <= data;
        fraction <= MillisecondWidth'(MillisecondClocks - 1);
      end
      Wait: begin
        fraction <= fraction - MillisecondWidth'(1);
        if (fraction == '0) begin
          fraction <= MillisecondWidth'(MillisecondClocks - 1);
          milliseconds <= milliseconds - 8'd1;
        end
      end
      Send: begin
        if (sent && step == ReadBack) begin
          found <= caught[8:1];
          if (differs) begin
            attempt <= attempt + AttemptWidth'(1);
            state <= attempt == AttemptWidth'(Attempts - 1) ? Failed : Decode;
          end
        end
      end
      Done, Failed: ;
      default: ;
    endcase
    if (advance) begin
      attempt <= '0;
      if (entry == EntryWidth'(Entries - 1)) begin
        state <= Done;
      end else begin
        state <= Fetch;
        entry <= entry + EntryWidth'(1);
      end
    end
    if (rst || restart) begin
      state <= Fetch;
      entry <= '0;
      attempt <= '0;
      power_down <= 1'b1;
      reset_n <= 1'b0;
    end
  end

  // The camera's clock, in every state.

  logic [XclkWidth-1:0] xclk_count;
  always_ff @(posedge clk) begin
    xclk_count <= xclk_count - XclkWidth'(1);
    if (xclk_count == '0) begin
      xclk_count <= XclkWidth'(XclkHalfClocks - 1);
      xclk <= ~xclk;
    end
    if (rst) {xclk_count, xclk} <= '0;
  end

  if (AddressBytes < 1 || AddressBytes > 2) begin : g_refused_0
    AddressBytes_must_be_1_or_2 u_refused ();
  end
  if (QuarterClocks < 4) begin : g_refused_1
    QuarterClocks_must_be_at_least_4_the_line_takes_three_to_be_seen u_refused ();
  end
  if (MillisecondClocks < 2 || XclkHalfClocks < 1 || Attempts < 1 || Entries < 2) begin : g_refused_2
    MillisecondClocks_and_Entries_must_be_at_least_2_XclkHalfClocks_and_Attempts_1 u_refused ();
  end
  if (DeviceId < 0 || DeviceId > 254 || DeviceId % 2 != 0) begin : g_refused_3
    DeviceId_must_be_an_even_byte u_refused ();
  end

endmodule

`default_nettype wire
