// SPDX-License-Identifier: Apache-2.0
// depth_unit: whole frames of depth from what the solver puts out, less the zero offset if there is one.
//
//   solved --> frame_output --> [zero_offset] -+-> depth
//                  ^       \-> [zero_capture]  \-> depth_signature
//   frame end --> frame_tags --> depth_flags
//
// In brackets: with ZeroOffset. A tag waits for each frame that is in the solver: whether it was malformed, whether it
// is of a self-test, its bank of the zero offset, its time and its flags. A malformed frame does not leave, that of a
// self-test leaves into its signature alone. Stream in: bursts of the solver, Lanes depth codes in a beat. Stream out:
// those of whole frames under `en`, in the same order. Latency: 0 cycles; with ZeroOffset that of zero_offset. Models:
// models/tactile_depth/chip/depth/.

`default_nettype none

module depth_unit
  import td_config_pkg::*;
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter logic [ConfigBits-1:0] Config = DefaultConfig,
  localparam int Rows         = value(Config, RowsField),
  localparam int Columns      = value(Config, ColumnsField),
  localparam int DataWidth    = value(Config, DataWidthField),
  localparam int Lanes        = value(Config, LanesField),  // depths in a beat
  localparam int FrameLatency = value(Config, FrameLatencyField),  // pixel_frame_end to the first word of the solver
  localparam int Parity       = value(Config, ParityField),  // of the memories
  localparam int ZeroOffset   = value(Config, ZeroOffsetField),
  localparam int BlockLog2    = value(Config, BlockLog2Field)  // ZeroOffset
) (
  input  wire                         clk,
  input  wire                         rst,
  input  wire                         en,

  input  wire table_command_t         table_command,
  output table_answer_t               table_answer,
  input  wire  [3:0]                  table_bank,
  output logic [3:0]                  table_in_use,
  input  wire capture_command_t       capture_command,
  output capture_status_t             capture_status,
  output logic [$clog2(Lanes):0]      saturations,  // depths clipped in a cycle
  output logic                        out_of_step,  // a frame does not leave the solver when it is due
  output logic                        flipped,      // a word that was read from a memory has a flipped bit
  output logic                        busy,         // a frame is in the solver, or here

  input  wire                         pixel_frame_start,
  input  wire                         pixel_frame_end,
  input  wire                         pixel_bad,
  input  wire                         pixel_test,
  input  wire  [31:0]                 frame_time,  // of the frame that pixel_frame_end ends
  input  wire                         slope_flags_valid,  // behind pixel_frame_end
  input  wire frame_flags_t           slope_flags,

  input  wire                         burst_start,
  input  wire                         solved_frame_start,
  input  wire  [Lanes*DataWidth-1:0]  solved_data,  // depth codes, signed
  input  wire                         solver_clipped,  // for one cycle each, before the last depth of a frame

  output logic                        depth_valid,
  output depth_position_t             depth_position,
  output logic [Lanes*DataWidth-1:0]  depth_data,  // depth codes, signed
  output logic [31:0]                 depth_time,   // of the frame to which depth_data belongs
  output frame_flags_t                depth_flags,  // of that frame; counts with its last beat

  input  wire                         self_test,      // a self-test begins
  output logic [31:0]                 test_signature  // of the last one, 0 until its frame has left
);

  localparam int ToFlags = ZeroOffset != 0 ? 12 + $clog2(Lanes) : 1;  // at most, from due to the flags

  logic bank, tag_due, tag_bad, tag_test, tag_bank, tags_held, entering_clipped, tag_clipped;
  logic [31:0] tag_time;
  frame_flags_t tag_flags;
  assign bank = table_bank[TableSelectZero];
  frame_tags #(
    .Width(35), .LateWidth($bits(frame_flags_t)), .Latency(FrameLatency), .Keep(ToFlags), .Pixels(Rows * Columns)
  ) u_tags (
    .clk, .rst, .en, .push(pixel_frame_end), .tag({pixel_bad, pixel_test, bank, frame_time}), .marked(entering_clipped),
    .late(slope_flags_valid), .late_part(slope_flags), .mark(solver_clipped), .due(tag_due),
    .due_tag({tag_bad, tag_test, tag_bank, tag_time}), .late_tag(tag_flags), .late_marked(tag_clipped), .held(tags_held)
  );

  logic active, whole_valid, whole_test, whole_test_q, leaves, tested;
  depth_position_t whole_position;
  logic [Lanes*DataWidth-1:0] whole_data;
  frame_output #(.Width(Lanes * DataWidth), .Rows(Rows), .Columns(Columns / Lanes)) u_output (
    .clk, .rst, .en, .in_start(burst_start), .in_frame_start(solved_frame_start), .in_data(solved_data),
    .in_due(tag_due), .in_bad(tag_bad & ~tag_test), .active, .out_of_step,
    .out_valid(whole_valid), .out_position(whole_position), .out_data(whole_data)
  );

  assign whole_test = tag_due ? tag_test : whole_test_q;
  always_ff @(posedge clk) if (en) whole_test_q <= whole_test;

  depth_flags u_flags (
    .clk, .rst, .en, .frame_start(pixel_frame_start), .solver_clipped, .entering_clipped, .in_flags(tag_flags),
    .marked(tag_clipped), .zero_clipped(saturations != '0), .depth_starts(leaves & depth_position.frame_start),
    .depth_ends(leaves & depth_position.frame_end), .out_flags(depth_flags)
  );

  assign depth_valid = leaves & ~tested;
  depth_signature #(.Width(DataWidth), .Lanes(Lanes)) u_signature (
    .clk, .rst, .en, .clear(self_test), .in_valid(leaves & tested),
    .in_frame_start(depth_position.frame_start), .in_frame_end(depth_position.frame_end), .in_data(depth_data),
    .signature(test_signature)
  );

  // The zero offset. Its bank goes with the frame: while the frame was in the solver others have begun.

  if (ZeroOffset != 0) begin : g_zero_offset
    localparam int Side = side(Lanes, BlockLog2);  // nodes that are captured at once
    localparam int NodeWidth = $clog2(nodes(Rows, Columns, BlockLog2) / Side);
    logic zero_flipped, sums_flipped, in_use, zero_active, zero_write, captures, capture_start, capture_end;
    logic [Lanes*DataWidth-1:0] capture_data;
    logic [NodeWidth-1:0] zero_write_node;
    logic [Side*DataWidth-1:0] zero_written;
    zero_offset #(
      .TableFolder(TableFolder), .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Width(DataWidth),
      .Lanes(Lanes), .Parity(Parity)
    ) u_zero_offset (
      .clk, .rst, .en, .table_command, .table_answer, .table_bank(rst ? bank : tag_bank), .table_in_use(in_use),
      .capture_write(zero_write), .capture_write_node(zero_write_node), .capture_zero(zero_written),
      .in_valid(whole_valid), .in_position(whole_position), .in_data(whole_data),
      .out_valid(leaves), .out_position(depth_position), .out_data(depth_data), .active(zero_active), .saturations,
      .flipped(zero_flipped)
    );
    zero_capture #(
      .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Width(DataWidth), .MaxLog2(ZeroLog2),
      .Lanes(Lanes), .Parity(Parity)
    ) u_capture (
      .clk, .rst, .en(1'b1), .request(capture_command.request), .log2_frames(capture_command.log2_frames),
      .busy(capture_status.busy), .done(capture_status.done), .captured(capture_status.captured),
      .in_valid(captures), .in_frame_start(capture_start), .in_frame_end(capture_end), .in_data(capture_data),
      .map_write(zero_write), .map_write_node(zero_write_node), .map_write_zero(zero_written),
      .flipped(sums_flipped)
    );
    if (Lanes == 1) begin : g_depth  // behind long paths; several lanes have a register behind their first sums
      always_ff @(posedge clk) begin
        captures <= en & whole_valid & ~whole_test & ~rst;
        {capture_start, capture_end} <= {whole_position.frame_start, whole_position.frame_end};
        capture_data <= whole_data;
      end
    end else begin : g_depths
      assign captures = en & whole_valid & ~whole_test;
      assign {capture_start, capture_end} = {whole_position.frame_start, whole_position.frame_end};
      assign capture_data = whole_data;
    end
    assign table_in_use = 4'(in_use) << TableSelectZero;
    assign busy = tags_held | active | zero_active;
    assign flipped = zero_flipped | sums_flipped;
    // `tested` is of the frame that leaves, or leaves next: while none leaves, of that which came in last.
    logic depth_test, leaving;
    always_ff @(posedge clk) begin
      if (en && whole_valid && whole_position.frame_start) {depth_time, depth_test} <= {tag_time, tag_test};
      if (en && leaves) leaving <= ~depth_position.frame_end;
      if (en && (leaves ? depth_position.frame_end : ~leaving)) tested <= depth_test;
      if (rst) leaving <= 1'b0;
    end
  end else begin : g_as_solved
    assign leaves = whole_valid;
    assign tested = whole_test;
    assign depth_position = whole_position;
    assign depth_data = whole_data;
    assign depth_time = tag_time;
    assign {capture_status, table_answer, table_in_use, saturations, flipped} = '0;
    assign busy = tags_held | active;
  end

endmodule

`default_nettype wire
