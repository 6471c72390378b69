// SPDX-License-Identifier: Apache-2.0
// depth_store: keeps the newest whole depth frame with its record for a reader, while the next one comes.
//
// Stream in, always taken: depth as on m_axis of tactile_depth, tuser with the first beat of a frame, Rows * Columns /
// Lanes beats; what comes before the first tuser is dropped, and a tuser inside a frame begins it again. s_event: the
// words of each frame's record, behind its last depth and before the last depth of the next; the record of a frame that
// did not come whole is dropped. frame_valid: a frame with its record waits. frame_take, only while frame_valid and
// keep, takes it; from the next clock up to frame_done its values and words can be read: value_data 3 clocks after
// value_read with value_address, record_data 1 clock after record_word. value_read is low in the clock of frame_done.
// A frame that comes whole replaces one that waits. `skipped`: a whole frame is lost so. While keep is low, frames are
// not kept, and none is counted. Memory: two banks of a frame. Model:
// models/tactile_depth/chip/link/depth_store.py.

`default_nettype none

module depth_store
  import td_register_map_pkg::RecordWords;
#(
  parameter int Rows      = 128,
  parameter int Columns   = 128,  // a power of two
  parameter int DataWidth = 24,
  parameter int Lanes     = 1,    // depths in a beat, a power of two
  localparam int LaneBits = 8 * ((DataWidth + 7) / 8),
  localparam int PlaceWidth = $clog2(Rows * Columns)
) (
  input  wire                         clk,
  input  wire                         rst,
  input  wire                         keep,
  input  wire  [Lanes*LaneBits-1:0]   s_axis_tdata,
  input  wire                         s_axis_tvalid,
  input  wire                         s_axis_tlast,
  input  wire                         s_axis_tuser,
  input  wire  [31:0]                 s_event_tdata,
  input  wire                         s_event_tvalid,
  input  wire                         s_event_tlast,
  output logic                        skipped,
  output logic                        frame_valid,
  input  wire                         frame_take,
  input  wire                         frame_done,
  input  wire                         value_read,
  input  wire  [PlaceWidth-1:0]       value_address,  // in the order in which values came
  output logic signed [DataWidth-1:0] value_data,
  input  wire  [3:0]                  record_word,
  output logic [31:0]                 record_data
);

  localparam int Beats = Rows * Columns / Lanes;
  localparam int BeatWidth = $clog2(Beats);

  // Beats in. A frame has ended, and awaits its record, in bank ended_bank.

  logic in_frame, begins, ends, write_bank, read_bank, reading, awaited, ended_bank, word_comes, record_ends;
  logic [BeatWidth-1:0] next_beat, beat, written_beat;
  logic [Lanes*DataWidth-1:0] values, written_values;
  logic stored;  // the beat belongs to a frame
  logic [1:0] writes;  // of each bank, a clock after the beat: the memories of a bank are far apart
  assign begins = s_axis_tvalid & s_axis_tuser;
  assign ends = s_axis_tvalid & in_frame & ~s_axis_tuser & next_beat == BeatWidth'(Beats - 1);
  assign stored = s_axis_tvalid & (s_axis_tuser | in_frame);
  assign beat = s_axis_tuser ? '0 : next_beat;
  bank_choice u_banks (
    .clk, .rst, .keep, .write_begin(begins), .write_end(ends), .publish(record_ends), .write_bank,
    .waiting(frame_valid), .take(frame_take), .done(frame_done), .reading, .read_bank, .replaced(skipped)
  );
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    assign values[lane*DataWidth+:DataWidth] = DataWidth'(s_axis_tdata[lane*LaneBits+:LaneBits]);
  end

  logic [3:0] word;
  assign word_comes = s_event_tvalid & awaited;
  assign record_ends = word_comes & s_event_tlast;
  always_ff @(posedge clk) begin
    if (begins || ends) in_frame <= begins;
    if (s_axis_tvalid) next_beat <= beat + BeatWidth'(1);
    writes <= {stored & write_bank, stored & ~write_bank};
    written_beat <= beat;
    written_values <= values;
    if (ends) ended_bank <= write_bank;
    if (s_event_tvalid) word <= s_event_tlast ? '0 : word + 4'd1;
    awaited <= ends | (awaited & ~record_ends);
    if (rst) {in_frame, awaited, word} <= '0;
  end

  td_ram #(.Width(32), .Depth(2 * RecordWords)) u_records (
    .clk, .write_en(word_comes), .write_address({word, ended_bank}), .write_data(s_event_tdata),
    .read_en(reading), .read_address({record_word, read_bank}), .read_data(record_data)
  );

  // Values out: a register behind each memory, because block memories are slow and far apart; then the bank and the
  // lane, into a register.

  localparam int LaneLog2 = $clog2(Lanes);
  logic [LaneLog2:0] from;  // {bank, lane} of the value
  logic [1:0][LaneLog2:0] from_q;
  logic [1:0][Lanes*DataWidth-1:0] bank_q;
  logic [2*Lanes-1:0][DataWidth-1:0] values_q;
  assign from = (LaneLog2 + 1)'(value_address & PlaceWidth'($unsigned(Lanes - 1)))
      | ((LaneLog2 + 1)'(read_bank) << LaneLog2);
  assign values_q = bank_q;
  always_ff @(posedge clk) begin
    if (value_read) from_q[0] <= from;
    from_q[1] <= from_q[0];
    value_data <= values_q[from_q[1]];
  end
  for (genvar b = 0; b < 2; b++) begin : g_bank
    logic [Lanes*DataWidth-1:0] read_values;
    td_ram #(.Width(Lanes * DataWidth), .Depth(Beats)) u_values (
      .clk, .write_en(writes[b]), .write_address(written_beat), .write_data(written_values),
      .read_en(value_read & read_bank == 1'(b)), .read_address(value_address[PlaceWidth-1:LaneLog2]),
      .read_data(read_values)
    );
    always_ff @(posedge clk) bank_q[b] <= read_values;
  end

endmodule

`default_nettype wire
