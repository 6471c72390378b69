// SPDX-License-Identifier: Apache-2.0
// packet_decode: checks kind, length and fields of packets to the device, and gives each to whom it is for.
//
// Packets in as they leave packet_store, good and whole, one after another. A kind is taken in the second cycle in
// which it is offered, after it was judged. An ask gives `ask` and a select gives `select` for one clock, 1 cycle
// behind its last byte. Reads and writes leave at `request`, pictures at `picture`: their bytes but the kind, under
// valid and ready, in the cycle in which they come in. A packet of one of these kinds with a wrong length or field
// gives `bad` for one clock, 1 cycle behind the byte that shows it, and nothing else. A packet of another kind is
// dropped. Model: unpack in models/tactile_depth/chip/link/packets.py.

`default_nettype none

module packet_decode
  import td_link_pkg::*;
(
  input  wire         clk,
  input  wire         rst,
  input  wire         in_valid,
  output logic        in_ready,
  input  wire  [7:0]  in_data,
  input  wire         in_last,
  output logic        in_drop,         // the rest of the packet is not needed
  input  wire  [10:0] in_length,       // of the packet
  input  wire  [1:0]  in_length_mod3,
  output logic        bad,
  output logic        ask,
  output logic        select,
  output logic [1:0]  select_format,   // count with `select`
  output logic [4:0]  select_shift,
  output logic        request_valid,
  input  wire         request_ready,
  output logic [7:0]  request_data,
  output logic        request_last,
  output logic        request_write,   // 1: write, 0: read
  output logic        picture_valid,
  input  wire         picture_ready,
  output logic [7:0]  picture_data,
  output logic        picture_last
);

  localparam logic [10:0] SelectBytes = 11'd3;
  localparam logic [10:0] RequestHeader = 11'd2;  // bytes: kind, number of the request
  localparam logic [10:0] AddressBytes = 11'd2;
  localparam logic [10:0] AccessBytes = 11'd6;    // address and value
  localparam logic [10:0] PictureHeader = 11'd9;  // kind, number, row, first column
  localparam logic [10:0] PixelBytes = 11'd3;
  localparam logic [7:0] MostShift = 8'(LargestShift);

  // The byte that comes is a kind, or belongs to a packet of a good kind and length.
  typedef enum logic [1:0] {AtKind, AtSelect, AtRequest, AtPicture} at_t;
  at_t at, begins, begins_q;

  // How many bytes the header and from 1 to `most` parts have.
  function automatic logic sized(
    input logic [10:0] length, input logic [10:0] header, input logic [10:0] part, input logic [10:0] most
  );
    return length >= header + part && length <= header + part * most;
  endfunction

  logic known, known_q, fits, fits_q, judged;  // _q: of the kind that is offered since the cycle before
  logic even, takes, takes_kind, ends_select, good_select;
  assign even = ~in_length[0];
  always_comb begin
    known = 1'b1;
    fits = 1'b0;
    begins = AtKind;
    case (in_data)
      Ask: fits = in_length == 11'd1;
      Select: begin
        fits = in_length == SelectBytes;
        begins = AtSelect;
      end
      Read: begin
        fits = sized(in_length, RequestHeader, AddressBytes, 11'(MostAccesses)) & even;
        begins = AtRequest;
      end
      Write: begin
        fits = sized(in_length, RequestHeader, AccessBytes, 11'(MostAccesses)) & even & (in_length_mod3 == 2'd2);
        begins = AtRequest;
      end
      Picture: begin
        fits = sized(in_length, PictureHeader, PixelBytes, 11'(MostPixels)) & (in_length_mod3 == '0);
        begins = AtPicture;
      end
      default: known = 1'b0;
    endcase
  end

  logic format_good, bad_kind, bad_select;
  assign bad = bad_kind | bad_select;
  assign takes = in_valid & in_ready;
  assign takes_kind = in_valid & (at == AtKind) & judged;
  assign ends_select = in_valid & (at == AtSelect) & in_last;
  assign good_select = format_good & (in_data <= MostShift);
  assign in_drop = (at == AtKind) & ~(fits_q & (begins_q != AtKind));
  assign in_ready = (at == AtRequest) ? request_ready : (at == AtPicture) ? picture_ready : (at == AtSelect) | judged;
  assign request_valid = in_valid & (at == AtRequest);
  assign picture_valid = in_valid & (at == AtPicture);
  assign {request_last, request_data} = {in_last, in_data};
  assign {picture_last, picture_data} = {in_last, in_data};

  always_ff @(posedge clk) begin
    judged <= in_valid & (at == AtKind) & ~judged;
    {begins_q, fits_q, known_q} <= {begins, fits, known};
    bad_kind <= takes_kind & known_q & ~fits_q;
    bad_select <= ends_select & ~good_select;
    ask <= takes_kind & fits_q & (begins_q == AtKind);
    select <= ends_select & good_select;
    select_shift <= in_data[4:0];
    if (takes_kind) begin
      request_write <= in_data == Write;
      if (fits_q) at <= begins_q;
    end else if (takes && in_last) begin
      at <= AtKind;
    end
    if (in_valid && at == AtSelect && !in_last) begin
      select_format <= in_data[1:0];
      format_good <= in_data[7:2] == '0;
    end
    if (rst) begin
      bad_kind <= 1'b0;
      bad_select <= 1'b0;
      ask <= 1'b0;
      select <= 1'b0;
      at <= AtKind;
      judged <= 1'b0;
    end
  end

endmodule

`default_nettype wire
