// SPDX-License-Identifier: Apache-2.0
// fv_packet_decode: by its kind and length, a packet is an ask, a select, a request, a picture, a bad one or unknown.
// A kind is taken in the second clock in which it is offered. Bytes of requests and pictures but the kind leave in the
// clock in which they come, and are taken there; those of a select are taken at once; of any other packet nothing but
// the kind is taken. An ask, a select with good fields and
// one with bad ones are told once, one clock behind the byte that shows it.

wire [10:0] place = u_protocol.at;

// n parts of a size, 1 to `most`, behind a header.
function automatic logic parts(input int length, input int header, input int size, input int most);
  return length > header && (length - header) % size == 0 && (length - header) / size <= most;
endfunction

typedef enum logic [2:0] {Unknown, Wrong, IsAsk, IsSelect, IsRead, IsWrite, IsPicture} kind_t;
kind_t kind, kind_q, begun;
logic [7:0] format_q;
always_comb begin
  begun = Unknown;
  case (in_data)
    8'd1: begun = in_length == 11'd1 ? IsAsk : Wrong;
    8'd2: begun = in_length == 11'd3 ? IsSelect : Wrong;
    8'd3: begun = parts(32'(in_length), 2, 2, 128) ? IsRead : Wrong;
    8'd4: begun = parts(32'(in_length), 2, 6, 128) ? IsWrite : Wrong;
    8'd5: begun = parts(32'(in_length), 9, 3, 256) ? IsPicture : Wrong;
    default: begun = Unknown;
  endcase
  kind = place == '0 ? begun : kind_q;
end

logic taken, inside_packet, is_request, fields_end, fields_good, was_reset;
logic ask_due, select_due, bad_due, offered;  // offered: a kind, in the clock before, and not taken
logic [7:0] format_due, shift_due;
assign taken = in_valid & in_ready;
assign inside_packet = in_valid & (place != '0);
assign is_request = (kind_q == IsRead) | (kind_q == IsWrite);
assign fields_end = taken & (kind == IsSelect) & (place == 11'd2);
assign fields_good = (format_q < 8'd4) & (in_data < 8'd17);

always_ff @(posedge clk) begin
  was_reset <= rst;
  offered <= in_valid & (place == '0) & ~in_ready & ~rst;
  if (in_valid && place == '0) kind_q <= begun;
  if (taken && place == 11'd1) format_q <= in_data;
  ask_due <= taken & (kind == IsAsk) & (place == '0);
  select_due <= fields_end & fields_good;
  bad_due <= (taken & (kind == Wrong)) | (fields_end & ~fields_good);
  format_due <= format_q;
  shift_due <= in_data;
  if (rst) {ask_due, select_due, bad_due} <= '0;
end

always_comb begin
  if (started) begin
    told_once: assert ({ask, select, bad} == {ask_due, select_due, bad_due});
    if (select) its_fields: assert (8'(select_format) == format_due && 8'(select_shift) == shift_due);
    requests: assert (request_valid == (inside_packet && is_request));
    pictures: assert (picture_valid == (inside_packet && kind_q == IsPicture));
    if (request_valid) begin
      unchanged: assert ({request_last, request_data} == {in_last, in_data});
      which: assert (request_write == (kind_q == IsWrite));
      stalled: assert (in_ready == request_ready);
    end
    if (picture_valid) begin
      unchanged_pixels: assert ({picture_last, picture_data} == {in_last, in_data});
      stalled_pixels: assert (in_ready == picture_ready);
    end
    if (in_valid && place == '0) judged_first: assert (in_ready == offered);
    as_judged: assert (dut.judged == offered);
    if (offered && in_valid && !rst) begin
      judged_well: assert ({dut.begins_q, dut.fits_q, dut.known_q} == {dut.begins, dut.fits, dut.known});
    end
    if (in_valid && place != '0 && kind_q == IsSelect) at_once: assert (in_ready);
    if (in_valid && in_ready && !rst) begin
      the_rest: assert (in_drop == (place == '0 && kind inside {Unknown, Wrong, IsAsk}));
    end
    if (place != '0) begin
      goes_on: assert (kind_q inside {IsSelect, IsRead, IsWrite, IsPicture} && place < u_protocol.length);
      not_cut: assert (u_protocol.length < 11'd1024);
    end
    as_begun: assert (dut.at == (place == '0 ? 2'd0 : kind_q == IsSelect ? 2'd1 : is_request ? 2'd2 : 2'd3));
    if (place != '0 && is_request) which_kept: assert (dut.request_write == (kind_q == IsWrite));
    if (place != '0 && kind_q == IsSelect) three: assert (place < 11'd3 && u_protocol.length == 11'd3);
    if (place == 11'd2 && kind_q == IsSelect) begin
      first_field: assert (dut.format_good == (format_q < 8'd4) && dut.select_format == format_q[1:0]);
    end
    whole_write: cover (request_valid && request_last && request_ready && request_write);
    whole_picture: cover (picture_valid && picture_last && picture_ready && place == 11'd14);
    good_select: cover (select && select_format == 2'd3 && select_shift == 5'd16);
    bad_select: cover (bad && format_due == 8'd3);
    silent: cover (taken && kind == Unknown && in_length > 11'd1);
  end
end

// Protocol: packets as they leave packet_store. A byte that was not taken is offered again; a packet has 1 to 2047
// bytes, the same length with each, and ends with the last of them, with that of a full bank, or where the core
// drops it. What is offered counts while it is valid.
module protocol_packet_decode;
  localparam logic [10:0] BankBytes = 11'd1024;
  logic stays, consistent;
  logic [10:0] at = '0, length, end_at;
  offer_stays #(.Width(22)) u_offer (
    .clk, .rst, .reset, .valid(in_valid), .ready(in_ready), .word({in_data, in_last, in_length, in_length_mod3}),
    .holds(stays)
  );
  assign end_at = in_length < BankBytes ? in_length : BankBytes;
  assign consistent = (in_length != '0) & (at == '0 | in_length == length) & (in_length_mod3 == 2'(in_length % 11'd3))
      & (in_last == (at + 11'd1 == end_at));
  assign holds = stays & (~in_valid | consistent);
  assign counts = live;
  assign counts_in_ready = live & in_valid;
  assign counts_in_drop = live & in_valid & in_ready & ~rst;
  assign {counts_select_format, counts_select_shift} = {2{live & select}};
  assign {counts_request_data, counts_request_last, counts_request_write} = {3{live & request_valid}};
  assign {counts_picture_data, counts_picture_last} = {2{live & picture_valid}};
  always_ff @(posedge clk) begin
    if (in_valid && in_ready) begin
      at <= in_last | in_drop ? '0 : at + 11'd1;
      length <= in_length;
    end
    if (reset) at <= '0;
  end
endmodule
