// SPDX-License-Identifier: Apache-2.0
// auto_zero: depth less the floor, what depth reads at its place where nothing touches.
//
//   out = sat( in - floor )
//
// The floor is as smooth as what makes it, lights that drift: means of blocks of 2^BlockLog2 by 2^BlockLog2 depths,
// which gain_map interpolates. Its words there are offset binary, so that it need not know of signs; floor_0.hex has
// them so at power-up. A node of the table or of the capture is signed, nodes row by row in the order of the stream.
// Stream in: frames of depth, whole but for a reset. Stream out: the same. Latency: 10 cycles; a gap or en low changes
// no depth. `active`: a frame is inside. Banks, bus and capture: see gain_map. Bit-accurate model:
// models/tactile_depth/calibration/auto_zero.py.

`default_nettype none

module auto_zero
  import stream_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Width     = 24,
  localparam int NodeWidth = $clog2((Rows / (1 << BlockLog2)) * (Columns / (1 << BlockLog2)))
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,

  input  wire                     table_bank,
  output logic                    table_in_use,
  input  wire                     table_write,
  input  wire                     table_read,
  input  wire  [NodeWidth-1:0]    table_index,
  input  wire  signed [Width-1:0] table_floor,
  output logic signed [Width-1:0] table_read_floor,

  input  wire                     capture_write,
  input  wire  [NodeWidth-1:0]    capture_write_node,
  input  wire  signed [Width-1:0] capture_floor,

  input  wire                     in_valid,
  input  wire depth_position_t    in_position,
  input  wire  signed [Width-1:0] in_data,           // depth code
  output logic                    out_valid,
  output depth_position_t         out_position,
  output logic signed [Width-1:0] out_data,          // depth code
  output logic                    active,            // a frame is inside
  output logic                    saturation         // a value was clipped
);

  localparam logic [Width-1:0] Zero = {1'b1, {(Width - 1) {1'b0}}};  // in offset binary

  logic floor_valid, map_active;
  depth_position_t floor_position;
  logic [Width-1:0] table_word, floor_word, unused_capture_word;
  logic signed [Width-1:0] depth;
  gain_map #(
    .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Width(Width), .Channels(1), .DataWidth(3 + Width),
    .Name({TableFolder, "floor"})
  ) u_map (
    .clk, .rst, .en, .table_bank, .table_in_use, .table_write, .table_read, .table_index({table_index, 2'd0}),
    .table_gain($unsigned(table_floor) ^ Zero), .table_read_gain(table_word),
    .capture_write, .capture_write_node, .capture_gains($unsigned(capture_floor) ^ Zero),
    .capture_read(1'b0), .capture_read_node(NodeWidth'(0)), .capture_read_gains(unused_capture_word),
    .in_valid, .in_frame_start(in_position.frame_start), .in_data({in_position, in_data}),
    .out_valid(floor_valid), .out_data({floor_position, depth}), .out_gains(floor_word), .active(map_active)
  );
  assign table_read_floor = table_word ^ Zero;

  logic signed [Width:0] difference;
  logic signed [Width-1:0] rounded;
  logic clipped, begun;  // begun: a frame is not all in yet
  assign difference = (Width + 1)'(depth) - (Width + 1)'($signed(floor_word ^ Zero));
  round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_saturate (
    .in(difference), .out(rounded), .clipped
  );
  assign active = begun | map_active | out_valid;

  always_ff @(posedge clk) begin
    if (en) begin
      if (in_valid) begun <= ~in_position.frame_end;
      out_valid <= floor_valid;
      out_position <= floor_position;
      out_data <= rounded;
    end
    saturation <= en & floor_valid & clipped;
    if (rst) begin
      out_valid <= 1'b0;
      begun <= 1'b0;
      saturation <= 1'b0;
    end
  end

endmodule

`default_nettype wire
