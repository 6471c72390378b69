// SPDX-License-Identifier: Apache-2.0
// zero_offset: depth less the zero offset, which is the depth that is computed while nothing touches.
//
//   out = sat( in - zero offset )
//
// The zero offset comes from lights that drift, so it is smooth: a mean for each block of 2^BlockLog2 by 2^BlockLog2
// depths, interpolated by td_gain_map, or with several lanes by td_node_map. These hold unsigned words, so the sign bit
// is inverted on the way in and out, and in zero_0.hex. A node on the bus or from the capture is signed; nodes go row
// by row in the order of the stream. Stream in: beats of Lanes depths, whole frames but for a reset. Stream out: the
// same. Latency: that of td_gain_map or td_node_map, and 1 cycle; a gap or en low changes no depth. `active`: a frame
// is inside. `saturations` counts the clipped depths of a beat. Banks, bus and capture: see td_gain_map and
// td_node_map. Bit-accurate model: models/tactile_depth/depth/zero_offset.py.

`default_nettype none

module zero_offset
  import td_types_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Width     = 24,
  parameter int Lanes     = 1,   // depths in a beat
  localparam int NodeWidth = $clog2(nodes(Rows, Columns, BlockLog2)),
  localparam int Side = side(Lanes, BlockLog2)  // nodes that the capture writes at once
) (
  input  wire                             clk,
  input  wire                             rst,
  input  wire                             en,

  input  wire                             table_bank,
  output logic                            table_in_use,
  input  wire                             table_write,
  input  wire                             table_read,
  input  wire  [NodeWidth-1:0]            table_index,
  input  wire  signed [Width-1:0]         table_zero,
  output logic signed [Width-1:0]         table_read_zero,

  input  wire                             capture_write,
  input  wire  [NodeWidth-$clog2(Side)-1:0] capture_write_node,
  input  wire  [Side*Width-1:0]           capture_zero,    // depth codes, signed

  input  wire                             in_valid,
  input  wire depth_position_t            in_position,
  input  wire  [Lanes*Width-1:0]          in_data,          // depth codes, signed
  output logic                            out_valid,
  output depth_position_t                 out_position,
  output logic [Lanes*Width-1:0]          out_data,         // depth codes, signed
  output logic                            active,           // a frame is inside
  output logic [$clog2(Lanes):0]          saturations       // clip count, delayed
);

  localparam logic [Width-1:0] Zero = {1'b1, {(Width - 1) {1'b0}}};  // in offset binary

  logic zero_valid, map_active;
  depth_position_t zero_position;
  logic [Width-1:0] table_word;
  logic [Lanes*Width-1:0] depths, zero_words;
  if (Lanes == 1) begin : g_one
    logic [Width-1:0] unused_capture_word;
    td_gain_map #(
      .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Width(Width), .Channels(1), .DataWidth(3 + Width),
      .Name({TableFolder, "zero"})
    ) u_map (
      .clk, .rst, .en, .table_bank, .table_in_use, .table_write, .table_read, .table_index({table_index, 2'd0}),
      .table_gain($unsigned(table_zero) ^ Zero), .table_read_gain(table_word),
      .capture_write, .capture_write_node, .capture_gains(capture_zero ^ Zero),
      .capture_read(1'b0), .capture_read_node(NodeWidth'(0)), .capture_read_gains(unused_capture_word),
      .in_valid, .in_frame_start(in_position.frame_start), .in_data({in_position, in_data}),
      .out_valid(zero_valid), .out_data({zero_position, depths}), .out_gains(zero_words), .active(map_active)
    );
  end else begin : g_lanes
    td_node_map #(
      .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Width(Width), .Lanes(Lanes),
      .DataWidth(3 + Lanes * Width), .Name({TableFolder, "zero"})
    ) u_map (
      .clk, .rst, .en, .table_bank, .table_in_use, .table_write, .table_read, .table_index,
      .table_zero($unsigned(table_zero) ^ Zero), .table_read_zero(table_word),
      .capture_write, .capture_write_node, .capture_zeros(capture_zero ^ {Side{Zero}}),
      .in_valid, .in_frame_start(in_position.frame_start), .in_data({in_position, in_data}),
      .out_valid(zero_valid), .out_data({zero_position, depths}), .out_zeros(zero_words), .active(map_active)
    );
  end
  assign table_read_zero = table_word ^ Zero;

  logic [Lanes*Width-1:0] rounded;
  logic [Lanes-1:0] clipped;
  logic [$clog2(Lanes):0] count;  // of clipped values
  logic begun;                    // a frame is not all in yet
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    logic signed [Width-1:0] depth, zero;
    logic signed [Width:0] difference;
    assign depth = depths[lane*Width+:Width];
    assign zero = zero_words[lane*Width+:Width] ^ Zero;
    assign difference = (Width + 1)'(depth) - (Width + 1)'(zero);
    td_round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_saturate (
      .in(difference), .out(rounded[lane*Width+:Width]), .clipped(clipped[lane])
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
    if (rst) begin
      out_valid <= 1'b0;
      begun <= 1'b0;
      saturations <= '0;
    end
  end

endmodule

`default_nettype wire
