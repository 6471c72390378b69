// SPDX-License-Identifier: Apache-2.0
// td_gain_map: the gain of every pixel, interpolated between those of a coarse grid of nodes.
//
//   2b g = (2b - w) G[node] + w G[node + 1],  2 i + 1 - b = 2b node + w, clamped to the first and the last node,
//
// along rows and columns alike for blocks of b = 2^BlockLog2 pixels; exact, then one rounding half to even.
// Down a column by a multiplication of each node as it is read, along a row by an accumulator: two nodes a block.
// Stream in: data of the pixels of whole frames, raster order. Stream out: the same, with the gains {B, G, R} of each
// pixel. Latency: 10 cycles; a gap in, a gap out.
// Gains are held in banked tables. A frame uses the bank that table_bank names with its first pixel, or in reset;
// table_in_use says which. The other is written and read by the bus (a gain at index 4 node + channel: red 0, green
// 1, blue 2; a channel that is not there is not written and reads 0) or by the capture (all gains of a node, read one
// cycle later). Nothing is written while a change-over is due (table_bank is not table_in_use). A table_read stands on
// table_read_gain from 2 cycles later until the next, en or not; no write until then. What the bus reads while the
// capture reads is left open. <Name>_0, 1 and 2.hex give both banks at power-up; a memory without contents there must
// be written before the first frame. Bit-accurate model: models/tactile_depth/common/td_gain_map.py.

`default_nettype none

module td_gain_map #(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Width     = 24,  // of a gain; its fraction bits are those of the nodes
  parameter int Channels  = 3,   // at most 3
  parameter int DataWidth = 24,
  parameter     Name      = "gain",
  localparam int NodeColumns = Columns / (1 << BlockLog2),
  localparam int NodeRows = Rows / (1 << BlockLog2),
  localparam int NodeWidth = $clog2(NodeRows * NodeColumns)
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,

  input  wire                       table_bank,
  output logic                      table_in_use,
  input  wire                       table_write,
  input  wire                       table_read,
  input  wire  [NodeWidth+1:0]      table_index,
  input  wire  [Width-1:0]          table_gain,
  output logic [Width-1:0]          table_read_gain,

  input  wire                       capture_write,
  input  wire  [NodeWidth-1:0]      capture_write_node,
  input  wire  [Channels*Width-1:0] capture_gains,
  input  wire                       capture_read,
  input  wire  [NodeWidth-1:0]      capture_read_node,
  output logic [Channels*Width-1:0] capture_read_gains,

  input  wire                       in_valid,
  input  wire                       in_frame_start,  // with the first pixel of a frame
  input  wire  [DataWidth-1:0]      in_data,
  output logic                      out_valid,
  output logic [DataWidth-1:0]      out_data,
  output logic [Channels*Width-1:0] out_gains,       // unsigned
  output logic                      active           // a pixel is inside
);

  localparam int Latency = 10;
  localparam int ToSum = 7;  // stages from the position to the accumulator
  localparam int Half = 1 << (BlockLog2 - 1);
  localparam int ColumnWidth = $clog2(Columns);
  localparam int NodeColumnWidth = ColumnWidth - BlockLog2;
  localparam int ShareBits = BlockLog2 + 1;  // 2b is 2^ShareBits
  localparam int SumWidth = Width + ShareBits;
  localparam int GainWidth = SumWidth + ShareBits;

  td_delay_line #(.Width(DataWidth), .Delay(Latency)) u_delay (.clk, .rst, .en, .in(in_data), .out(out_data));

  // Column of the pixel. Columns are counted from half a block on, so that a node begins at phase 0; columns
  // before the first and behind the last node's centre both count as the last node's: there the gain stands still.

  logic [Latency-1:0] valid_q;
  logic frame_start_q, row_start_q, row_starts, row_ended, begins, inner, segment;
  logic [ColumnWidth-1:0] column, shifted;
  logic [NodeColumnWidth-1:0] node;
  assign row_ended = column == '1;
  assign row_starts = valid_q[0] & row_start_q;
  assign shifted = column - ColumnWidth'(Half);
  assign node = shifted[ColumnWidth-1:BlockLog2];
  assign begins = shifted[BlockLog2-1:0] == '0;
  assign inner = node != '1;
  assign segment = valid_q[0] & begins & inner;
  assign active = |valid_q;
  assign out_valid = valid_q[Latency-1];

  // Rows of the nodes above and below the pixels, and the phase between them: both are the same row above the first
  // node's centre and below the last node's.

  localparam int NodeRowWidth = NodeRows > 1 ? $clog2(NodeRows) : 1;
  localparam logic [NodeRowWidth-1:0] LastRow = NodeRowWidth'(NodeRows - 1);
  logic [NodeRowWidth-1:0] above, below;
  logic [BlockLog2-1:0] row_phase;
  always_ff @(posedge clk) begin
    if (en && in_valid) begin
      if (in_frame_start) begin
        {above, below} <= '0;
        row_phase <= BlockLog2'(Half);
      end else if (row_ended) begin
        row_phase <= row_phase + BlockLog2'(1);
        if (row_phase == '1) {above, below} <= {below, below == LastRow ? LastRow : below + NodeRowWidth'(1)};
      end
    end
  end

  // Reads of a row's first node come with its first pixel, those of every other node one cycle after the pixel at the
  // centre of the node before it. So two rows, or two frames, never meet, and at b = 2 a node is read in every cycle.
  // The last node of a frame is used up in the cycle of the next frame's first read.

  logic row_starts_q, segment_q, segment_q2, second, reading;
  logic [NodeColumnWidth-1:0] next_q, next_q2, read_column;
  logic [NodeWidth-1:0] read_node;
  assign second = row_starts_q | segment_q2;  // the node below
  assign reading = row_starts | segment_q | second;
  always_comb begin
    read_column = '0;
    if (segment_q) read_column = next_q;
    if (segment_q2) read_column = next_q2;
  end
  assign read_node = NodeWidth'({second ? below : above, read_column});

  logic [ShareBits-1:0] share;
  logic [ShareBits:0] weight, weight_q, weight_q2;
  assign share = {row_phase, 1'b1};  // of the node below: above the first and below the last both are one
  assign weight = second ? {1'b0, share} : {1'b1, {ShareBits{1'b0}}} - {1'b0, share};

  // The tables, one for each channel. Capture and bus share the ports of the free bank.

  logic [NodeWidth-1:0] table_node, write_node, free_node;
  logic [1:0] channel, fetched_channel;
  logic fetched;
  logic [3:0][Width-1:0] free_gains;
  logic [Channels*Width-1:0] gains, gains_q;
  logic [Channels-1:0] in_use;
  assign {table_node, channel} = table_index;
  assign write_node = capture_write ? capture_write_node : table_node;
  assign free_node = capture_read ? capture_read_node : table_node;
  assign table_in_use = &in_use;  // they change over together
  for (genvar c = 0; c < Channels; c++) begin : g_table
    td_banked_table #(.Width(Width), .Depth(NodeRows * NodeColumns), .File({Name, "_", 8'(48 + c), ".hex"})) u_gains (
      .clk, .rst, .en, .table_bank, .table_in_use(in_use[c]),
      .frame_start(in_valid & in_frame_start), .change(valid_q[0] & frame_start_q),
      .read(reading), .read_address(read_node), .read_word(gains[c*Width+:Width]),
      .free_write(capture_write | (table_write & channel == 2'(c))), .free_write_address(write_node),
      .free_write_word(capture_write ? capture_gains[c*Width+:Width] : table_gain),
      .free_read(capture_read | table_read), .free_read_address(free_node), .free_word(free_gains[c])
    );
    assign capture_read_gains[c*Width+:Width] = free_gains[c];
  end
  assign free_gains[3:Channels] = '0;

  // Stages behind the read: the register behind the memories, the product, the sum.

  logic second_q, second_q2, first_q3, node_done, segment_done;
  logic [2:0] segment_read_q;
  logic [ToSum-1:0] begins_q, inner_q, start_q;

  always_ff @(posedge clk) begin
    if (en) begin
      valid_q <= {valid_q[Latency-2:0], in_valid};
      if (in_valid) begin
        frame_start_q <= in_frame_start;
        row_start_q <= in_frame_start | row_ended;
        column <= in_frame_start ? '0 : column + ColumnWidth'(1);
      end
      row_starts_q <= row_starts;
      {segment_q2, segment_q} <= {segment_q, segment};
      {next_q2, next_q} <= {next_q, node + NodeColumnWidth'(1)};
      {weight_q2, weight_q} <= {weight_q, weight};
      gains_q <= gains;
      {second_q2, second_q} <= {second_q, second};
      first_q3 <= ~second_q2;
      segment_read_q <= {segment_read_q[1:0], segment_q2};
      node_done <= ~first_q3;
      segment_done <= segment_read_q[2];
      begins_q <= {begins_q[ToSum-2:0], begins};
      inner_q <= {inner_q[ToSum-2:0], inner};
      start_q <= {start_q[ToSum-2:0], row_start_q};
    end
    fetched <= table_read;
    if (table_read) fetched_channel <= channel;
    if (fetched) table_read_gain <= free_gains[fetched_channel];
    if (rst) begin
      valid_q <= '0;
      row_starts_q <= 1'b0;
      {second_q2, second_q} <= '0;
      first_q3 <= 1'b1;
      {segment_q2, segment_q, segment_read_q} <= '0;
      {node_done, segment_done} <= '0;
    end
  end

  // Each channel: weigh a node and the one below it, then run along the row from node to node.

  logic [Channels*SumWidth-1:0] sums;
  logic start, node_begins, between;
  assign start = start_q[ToSum-1];
  assign node_begins = begins_q[ToSum-1];
  assign between = inner_q[ToSum-1];
  for (genvar c = 0; c < Channels; c++) begin : g_along
    logic [SumWidth-1:0] sum, left, right;  // right: of the node that was done last; left: of the one before it
    assign sum = sums[c*SumWidth+:SumWidth];
    logic signed [Width+ShareBits+2:0] product;
    td_multiply #(.AWidth(Width + 1), .BWidth(ShareBits + 2)) u_product (
      .clk, .en, .a({1'b0, gains_q[c*Width+:Width]}), .b({1'b0, weight_q2}), .product
    );
    logic unused_signs;
    assign unused_signs = ^product[Width+ShareBits+2:SumWidth];
    logic signed [SumWidth:0] step;
    logic [GainWidth-1:0] gain, from;
    logic signed [GainWidth-1:0] add;
    logic signed [Width:0] rounded;
    logic unused_clipped, unused_sign;
    assign from = start ? {right, {ShareBits{1'b0}}} : node_begins & between ? {left, {ShareBits{1'b0}}} : gain;
    assign add = node_begins ? GainWidth'(step) : between ? GainWidth'(step) <<< 1 : '0;
    td_round_saturate #(.InWidth(GainWidth + 1), .Drop(2 * ShareBits), .OutWidth(Width + 1)) u_round (
      .in({1'b0, gain}), .out(rounded), .clipped(unused_clipped)
    );
    assign unused_sign = rounded[Width];
    always_ff @(posedge clk) begin
      if (en) begin
        // In this form: with the sum first, Yosys 0.70 packs it into a DSP48 with the choice inverted.
        sums[c*SumWidth+:SumWidth] <= (first_q3 ? '0 : sum) + product[SumWidth-1:0];
        if (node_done) right <= sum;
        if (segment_done) begin
          left <= right;
          step <= $signed({1'b0, sum}) - $signed({1'b0, right});
        end
        if (valid_q[ToSum]) gain <= from + $unsigned(add);
        out_gains[c*Width+:Width] <= rounded[Width-1:0];
      end
    end
  end

  if (BlockLog2 < 1) begin : g_refused_0
    BlockLog2_must_be_at_least_1_a_node_is_read_in_a_clock_and_two_are_needed u_refused ();
  end
  if (Columns != 1 << ColumnWidth) begin : g_refused_1
    Columns_must_be_a_power_of_two u_refused ();
  end
  if (NodeColumns < 2 || NodeRows < 1) begin : g_refused_2
    two_blocks_a_row_and_one_a_column_are_needed u_refused ();
  end

endmodule

`default_nettype wire
