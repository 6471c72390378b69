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

module auto_zero #(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Width     = 24,
  localparam int NodeWidth = $clog2((Rows / (1 << BlockLog2)) * (Columns / (1 << BlockLog2)))
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    en,

  input  logic                    table_bank,
  output logic                    table_in_use,
  input  logic                    table_write,
  input  logic                    table_read,
  input  logic [NodeWidth-1:0]    table_index,
  input  logic signed [Width-1:0] table_floor,
  output logic signed [Width-1:0] table_read_floor,

  input  logic                    capture_write,
  input  logic [NodeWidth-1:0]    capture_write_node,
  input  logic signed [Width-1:0] capture_floor,

  input  logic                    in_valid,
  input  logic                    in_user,       // with the first word of a frame
  input  logic                    in_last,       // with the last of a row
  input  logic                    in_frame_end,  // with the last of a frame
  input  logic signed [Width-1:0] in_data,
  output logic                    out_valid,
  output logic                    out_user,
  output logic                    out_last,
  output logic                    out_frame_end,
  output logic signed [Width-1:0] out_data,
  output logic                    active,
  output logic                    saturation     // a value was clipped
);

  localparam int MapLatency = 9;
  localparam int Latency = MapLatency + 1;
  localparam logic [Width-1:0] Zero = {1'b1, {(Width - 1) {1'b0}}};  // in offset binary

  logic row_ended, floor_valid;
  logic [3:0] floor_place;
  logic [Width-1:0] table_word, floor_word, unused_capture_word;
  gain_map #(
    .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Width(Width), .Channels(1), .Name("floor")
  ) u_map (
    .clk, .rst, .en, .table_bank, .table_in_use, .table_write, .table_read, .table_index({table_index, 2'd0}),
    .table_gain($unsigned(table_floor) ^ Zero), .table_read_gain(table_word),
    .capture_write, .capture_write_node, .capture_gains($unsigned(capture_floor) ^ Zero),
    .capture_read(1'b0), .capture_read_node(NodeWidth'(0)), .capture_read_gains(unused_capture_word),
    .in_valid, .in_place({in_last, in_frame_end, in_user | row_ended, in_user}),
    .out_valid(floor_valid), .out_place(floor_place), .out_gains(floor_word)
  );
  assign table_read_floor = table_word ^ Zero;

  logic [Width-1:0] data_q;
  delay_line #(.Width(Width), .Delay(MapLatency)) u_delay (.clk, .rst, .en, .in(in_data), .out(data_q));

  logic signed [Width:0] difference;
  logic signed [Width-1:0] rounded;
  logic clipped, unused_row_begins;
  assign difference = (Width + 1)'($signed(data_q)) - (Width + 1)'($signed(floor_word ^ Zero));
  round_saturate #(.InWidth(Width + 1), .Drop(0), .OutWidth(Width)) u_saturate (
    .in(difference), .out(rounded), .clipped
  );
  assign unused_row_begins = floor_place[1];

  logic begun;          // a frame that is not all in yet
  logic [3:0] leaving;  // clocks until the last word of one has left; the next may be inside by then
  assign active = begun | leaving != '0;

  always_ff @(posedge clk) begin
    if (en) begin
      if (in_valid) row_ended <= in_last;
      out_valid <= floor_valid;
      out_user <= floor_place[0];
      out_frame_end <= floor_place[2];
      out_last <= floor_place[3];
      out_data <= rounded;
      if (in_valid) begun <= ~in_frame_end;
      if (in_valid && in_frame_end) leaving <= 4'($unsigned(Latency));
      else if (leaving != '0) leaving <= leaving - 4'd1;
    end
    saturation <= en & floor_valid & clipped;
    if (rst) begin
      out_valid <= 1'b0;
      begun <= 1'b0;
      leaving <= '0;
      saturation <= 1'b0;
    end
  end

endmodule
