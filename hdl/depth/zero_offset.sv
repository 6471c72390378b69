// SPDX-License-Identifier: Apache-2.0
// zero_offset: depth less the zero offset, which is the depth that is computed while nothing touches.
//
//   out = sat( in - zero offset )
//
// The zero offset comes from lights that drift, so it is smooth: a mean for each block of 2^BlockLog2 by 2^BlockLog2
// depths, interpolated by td_node_map; nodes go row by row in the order of the stream. Stream in: beats of Lanes
// depths, whole frames but for a reset. Stream out: the same. Latency: that of td_node_map, and 1 cycle; a gap or en
// low changes no depth. `active`: a frame is inside. `saturations` counts the clipped depths of a beat. Table port:
// docs/streams.md; a zero offset is at the index of its node. Bit-accurate model:
// models/tactile_depth/chip/depth/zero_offset.py.

`default_nettype none

module zero_offset
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Width     = 24,
  parameter int Lanes     = 1,   // depths in a beat
  parameter int Parity    = 0,   // 1: a parity bit in each word of a memory
  localparam int Side = side(Lanes, BlockLog2),  // nodes that the capture writes at once
  localparam int NodeWidth = $clog2(nodes(Rows, Columns, BlockLog2) / Side)
) (
  input  wire                             clk,
  input  wire                             rst,
  input  wire                             en,

  input  wire table_command_t             table_command,
  output table_answer_t                   table_answer,
  input  wire                             table_bank,
  output logic                            table_in_use,

  input  wire                             capture_write,
  input  wire  [NodeWidth-1:0]            capture_write_node,  // of Side nodes
  input  wire  [Side*Width-1:0]           capture_zero,        // depth codes, signed

  input  wire                             in_valid,
  input  wire depth_position_t            in_position,
  input  wire  [Lanes*Width-1:0]          in_data,             // depth codes, signed
  output logic                            out_valid,
  output depth_position_t                 out_position,
  output logic [Lanes*Width-1:0]          out_data,            // depth codes, signed
  output logic                            active,              // a frame is inside
  output logic [$clog2(Lanes):0]          saturations,         // clip count, delayed
  output logic                            flipped              // a word that was read, or a zero offset, has one
);

  logic zero_valid, map_active, map_flipped;
  depth_position_t zero_position;
  logic [Lanes-1:0][Width-1:0] depths, zero_words, rounded;
  td_node_map #(
    .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Width(Width), .Signed(1), .Lanes(Lanes),
    .DataWidth(3 + Lanes * Width), .Select(TableSelectZero), .Name({TableFolder, "zero"}),
    .Parity(Parity)
  ) u_map (
    .clk, .rst, .en, .table_command, .table_answer, .table_bank, .table_in_use,
    .capture_write, .capture_write_node, .capture_words(capture_zero),
    .capture_read(1'b0), .capture_read_node(capture_write_node), .capture_read_words(),
    .in_valid, .in_frame_start(in_position.frame_start), .in_data({in_position, in_data}),
    .out_valid(zero_valid), .out_data({zero_position, depths}), .out_words(zero_words), .active(map_active),
    .flipped(map_flipped)
  );
  if (Parity == 0) begin : g_plain
    assign flipped = map_flipped;
  end else begin : g_check  // zero offsets come from the table alone
    logic differs;
    assign flipped = map_flipped | differs;
    td_repeat_check #(.Width(Lanes * Width)) u_repeat (
      .clk, .rst, .en, .in_valid(zero_valid), .in_first(zero_position.frame_start),
      .in_last(zero_position.frame_end), .in_bank(table_in_use), .in_data(zero_words), .differs
    );
  end

  logic [Lanes-1:0] clipped;
  logic [$clog2(Lanes):0] count;  // of clipped values
  logic begun;                    // a frame is not all in yet
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    logic signed [Width-1:0] depth, zero;
    logic signed [Width:0] difference;
    assign depth = depths[lane];
    assign zero = zero_words[lane];
    assign difference = (Width + 1)'(depth) - (Width + 1)'(zero);
    td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_saturate (
      .in(difference), .out(rounded[lane]), .clipped(clipped[lane])
    );
  end
  always_comb begin
    count = '0;
    for (int lane = 0; lane < Lanes; lane++) count += ($clog2(Lanes) + 1)'(clipped[lane]);
  end
  assign active = begun | map_active | out_valid;

  always_ff @(posedge clk) begin
    if (en) begin
      if (in_valid) begun <= ~in_position.frame_end;
      out_valid <= zero_valid;
      out_position <= zero_position;
      out_data <= rounded;
    end
    saturations <= en & zero_valid ? count : '0;
    if (rst) {out_valid, begun, saturations} <= '0;
  end

endmodule

`default_nettype wire
