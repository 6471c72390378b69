// SPDX-License-Identifier: Apache-2.0
// protocol_depth_store: any beats; a record of 12 words behind the last beat of its frame and before the last beat of the
// next, or without a frame, between last beats too. The reader takes a frame that waits, and reads inside it; what
// it reads counts.

`default_nettype none

module protocol_depth_store #(
  parameter int Rows    = 128,
  parameter int Columns = 128,
  parameter int Lanes   = 1,
  localparam int Pixels = Rows * Columns,
  localparam int PlaceWidth = $clog2(Pixels)
) (
  input  logic                  clk,
  input  logic                  rst,
  input  logic                  keep,
  input  logic                  s_axis_tvalid,
  input  logic                  s_axis_tuser,
  input  logic                  s_event_tvalid,
  input  logic                  s_event_tlast,
  input  logic                  frame_valid,
  input  logic                  frame_take,
  input  logic                  frame_done,
  input  logic                  value_read,
  input  logic [PlaceWidth-1:0] value_address,
  input  logic [3:0]            record_word,
  output logic                  written,  // a beat belongs to a frame
  output logic [PlaceWidth:0]   beat,     // its place
  output logic                  begins,
  output logic                  ends,
  output logic                  awaited,  // a frame awaits its record
  output logic [3:0]            word,
  output logic                  reading,
  output logic                  holds,
  output logic                  counts_value_data,
  output logic                  counts_record_data,
  output logic                  counts
);

  localparam int Beats = Pixels / Lanes;

  logic live = 1'b0, in_frame = 1'b0, waits = 1'b0, taken = 1'b0, was_taken = 1'b0, known = 1'b0, known_q = 1'b0;
  logic [PlaceWidth:0] next_beat = '0;
  logic [3:0] next_word = '0;
  assign begins = s_axis_tvalid & s_axis_tuser;
  assign written = s_axis_tvalid & (s_axis_tuser | in_frame);
  assign beat = s_axis_tuser ? '0 : next_beat;
  assign ends = written & beat == (PlaceWidth + 1)'(Beats - 1);
  assign awaited = waits;
  assign word = next_word;
  assign reading = taken;
  assign holds = (rst | ((~ends | (~waits & next_word == '0 & ~s_event_tvalid))
      & (~s_event_tvalid | s_event_tlast == (next_word == 4'd11))))
      & (~frame_take | (frame_valid & keep & ~taken)) & (~frame_done | taken) & (~value_read | (taken & ~frame_done & 32'(value_address) < Pixels))
      & record_word <= 4'd11;
  assign counts = live & ~rst & holds;
  assign counts_value_data = counts & known_q;
  assign counts_record_data = counts & was_taken;
  always_ff @(posedge clk) begin
    live <= live | rst | ~holds;
    if (s_axis_tvalid) next_beat <= beat + (PlaceWidth + 1)'(1);
    if (begins || ends) in_frame <= begins;
    if (s_event_tvalid) next_word <= s_event_tlast ? '0 : next_word + 4'd1;
    waits <= ends | (waits & ~(s_event_tvalid & s_event_tlast));
    taken <= frame_take | (taken & ~frame_done);
    was_taken <= taken;
    known <= known | (value_read & holds);
    known_q <= known;
    if (rst || !holds) begin
      in_frame <= 1'b0;
      next_word <= '0;
      waits <= 1'b0;
      taken <= 1'b0;
      was_taken <= 1'b0;
    end
  end

endmodule

`default_nettype wire
