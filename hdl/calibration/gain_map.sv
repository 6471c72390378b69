// SPDX-License-Identifier: Apache-2.0
// gain_map: the gain of every pixel, interpolated between those of a coarse grid of nodes.
//
//   2b g = (2b - w) G[node] + w G[node + 1],  2 i + 1 - b = 2b node + w, clamped to the first and the last node,
//
// along rows and columns alike for blocks of b = 2^BlockLog2 pixels; exact, then one rounding half to even.
// Down a column by a multiplication of each node as it is read, along a row by an accumulator: two nodes a block.
// Stream in: places of pixels in raster order. Stream out: their gains {B, G, R}, unsigned. Latency: 9 cycles; a gap or
// en low changes no gain. Gains are held in two banks. A frame uses the bank that table_bank names one enabled clock
// after its first place came, or in reset; table_in_use says which. The other is written and read by the bus (a gain at
// index 4 node + channel: red 0, green 1, blue 2; a channel that is not there is not written and reads 0) or by the
// capture (all gains of a node, read one clock later). Nothing is written while a change-over is due (table_bank is not
// table_in_use). A table_read stands on table_read_gain from 3 clocks later until the next, en or not; no write until
// then. What the bus reads while the capture reads is left open. <Name>_0, 1 and 2.hex give both banks at power-up; a
// memory without contents there must be written before the first frame. Bit-accurate model:
// models/tactile_depth/calibration/gain_map.py.

module gain_map #(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Width     = 24,
  parameter int Channels  = 3,   // at most 3
  parameter     Name      = "gain",
  localparam int NodeColumns = Columns / (1 << BlockLog2),
  localparam int NodeRows = Rows / (1 << BlockLog2),
  localparam int NodeWidth = $clog2(NodeRows * NodeColumns)
) (
  input  logic                 clk,
  input  logic                 rst,
  input  logic                 en,

  input  logic                 table_bank,
  output logic                 table_in_use,
  input  logic                 table_write,
  input  logic                 table_read,
  input  logic [NodeWidth+1:0] table_index,
  input  logic [Width-1:0]     table_gain,
  output logic [Width-1:0]     table_read_gain,

  input  logic                 capture_write,
  input  logic [NodeWidth-1:0] capture_write_node,
  input  logic [Channels*Width-1:0] capture_gains,
  input  logic                 capture_read,
  input  logic [NodeWidth-1:0] capture_read_node,
  output logic [Channels*Width-1:0] capture_read_gains,

  input  logic                 in_valid,
  input  logic [3:0]           in_place,  // in the first row, first column, last row, last column
  output logic                 out_valid,
  output logic [3:0]           out_place,
  output logic [Channels*Width-1:0] out_gains
);

  localparam int Latency = 9;
  localparam int ToSum = 6;  // stages from the place to the accumulator
  localparam int Half = 1 << (BlockLog2 - 1);
  localparam int ColumnWidth = $clog2(Columns);
  localparam int RowWidth = $clog2(Rows) + 1;
  localparam int NodeColumnWidth = ColumnWidth - BlockLog2;
  localparam int ShareBits = BlockLog2 + 1;  // 2b is 2^ShareBits
  localparam int SumWidth = Width + ShareBits;
  localparam int GainWidth = SumWidth + ShareBits;

  // Where the pixel is. Columns are counted from half a block on, so that a node begins at phase 0; columns before the
  // first and behind the last node's centre both count as the last node's: there the gain stands still.

  logic [Latency-1:0] valid_q;
  logic [4*Latency-1:0] place_q;
  logic [ColumnWidth-1:0] column, shifted;
  logic [RowWidth-1:0] row, row_shifted;
  logic [NodeColumnWidth-1:0] node;
  logic starts, begins, inner, segment;
  assign starts = valid_q[0] & place_q[1];
  assign shifted = column - ColumnWidth'(Half);
  assign node = shifted[ColumnWidth-1:BlockLog2];
  assign begins = shifted[BlockLog2-1:0] == '0;
  assign inner = node != '1;
  assign segment = valid_q[0] & begins & inner;

  logic [RowWidth-BlockLog2-1:0] node_row, lower_row;
  logic [BlockLog2-1:0] row_phase;
  logic above, below;
  assign row_shifted = row - RowWidth'(Half);
  assign above = row < RowWidth'($unsigned(Half));
  assign {node_row, row_phase} = row_shifted;
  assign below = RowWidth'(node_row) + RowWidth'(1) >= RowWidth'($unsigned(NodeRows));
  always_comb begin
    lower_row = node_row;
    if (below) lower_row = (RowWidth - BlockLog2)'(NodeRows - 1);
    if (above) lower_row = '0;
  end

  // Reads of a row's first node come with its first pixel, those of every other node one clock after the pixel at the
  // centre of the node before it. So two rows, or two frames, never meet, and at b = 2 a node is read in every clock.

  logic starts_q, segment_q, segment_q2, upper, below_too, reading;
  logic [NodeColumnWidth-1:0] next_q, next_q2, read_column;
  logic [RowWidth-BlockLog2-1:0] read_row;
  logic [NodeWidth-1:0] read_node;
  assign upper = starts_q | segment_q2;
  assign reading = en & (starts | segment_q | upper);
  assign below_too = upper & ~above & ~below;
  assign read_row = lower_row + (RowWidth - BlockLog2)'(below_too);
  always_comb begin
    read_column = '0;
    if (segment_q) read_column = next_q;
    if (segment_q2) read_column = next_q2;
  end
  assign read_node = NodeWidth'({read_row, read_column});

  logic [ShareBits-1:0] share;
  logic [ShareBits:0] weight, weight_q;
  assign share = {row_phase, 1'b1};  // of the node below: above the first and below the last both are one
  assign weight = upper ? {1'b0, share} : {1'b1, {ShareBits{1'b0}}} - {1'b0, share};

  // The banks. The last node of a frame is used up in the clock that changes over, and that has en, so the bank left is
  // free from the next clock on; in that clock itself the other is already being read, so a table_read waits one clock.

  logic bank, used, changes, late, fetch, fetched, fetched_bank;
  logic [1:0] fetched_channel;
  logic [NodeWidth+1:0] late_index, fetch_index;
  logic [1:0][Channels*Width-1:0] words;
  assign used = en & starts & place_q[0] ? table_bank : bank;
  assign changes = used != bank;
  assign fetch = (table_read & ~changes) | late;
  assign fetch_index = late ? late_index : table_index;
  assign table_in_use = bank;

  for (genvar b = 0; b < 2; b++) begin : g_bank
    logic pixel, free;
    logic [NodeWidth-1:0] read_address;
    logic [Channels*Width-1:0] gains;
    assign pixel = reading & (used == 1'(b));
    assign free = bank != 1'(b);
    assign read_address = pixel ? read_node : capture_read ? capture_read_node : fetch_index[NodeWidth+1:2];
    for (genvar c = 0; c < Channels; c++) begin : g_channel
      ram #(
        .Width(Width),
        .Depth(NodeRows * NodeColumns),
        .Style(1),
        .File ({Name, "_", 8'(48 + c), ".hex"})
      ) u_gains (
        .clk,
        .write_en     (free & (capture_write | (table_write & table_index[1:0] == 2'(c)))),
        .write_address(capture_write ? capture_write_node : table_index[NodeWidth+1:2]),
        .write_data   (capture_write ? capture_gains[c*Width+:Width] : table_gain),
        .read_en      (pixel | (free & (capture_read | fetch))),
        .read_address (read_address),
        .read_data    (gains[c*Width+:Width])
      );
    end
    assign words[b] = gains;
  end

  logic [Channels*Width-1:0] used_gains;
  logic [Channels*Width-1:0] fetched_gains;
  logic [3:0][Width-1:0] fetched_gain;  // of each channel
  assign fetched_gains = words[fetched_bank];
  for (genvar c = 0; c < Channels; c++) begin : g_fetched
    assign fetched_gain[c] = fetched_gains[c*Width+:Width];
  end
  assign fetched_gain[3:Channels] = '0;
  assign used_gains = words[bank];
  assign capture_read_gains = bank ? words[0] : words[1];

  // Stages behind the read.

  logic upper_q, segment_read_q, first_q2, segment_read_q2, node_done, segment_done;
  logic [ToSum-1:0] begins_q, inner_q, start_q;

  always_ff @(posedge clk) begin
    if (en) begin
      valid_q <= {valid_q[Latency-2:0], in_valid};
      place_q <= {place_q[4*Latency-5:0], in_place};
      if (in_valid) begin
        column <= in_place[1] ? '0 : column + ColumnWidth'(1);
        if (in_place[1]) row <= in_place[0] ? '0 : row + RowWidth'(1);
      end
      starts_q <= starts;
      segment_q <= segment;
      segment_q2 <= segment_q;
      next_q <= node + NodeColumnWidth'(1);
      next_q2 <= next_q;
      weight_q <= weight;
      upper_q <= upper;
      segment_read_q <= segment_q2;
      first_q2 <= ~upper_q;
      segment_read_q2 <= segment_read_q;
      node_done <= ~first_q2;
      segment_done <= segment_read_q2;
      begins_q <= {begins_q[ToSum-2:0], begins};
      inner_q <= {inner_q[ToSum-2:0], inner};
      start_q <= {start_q[ToSum-2:0], place_q[1]};
    end
    if (rst || (en && starts && place_q[0])) bank <= table_bank;
    late <= table_read & changes;
    late_index <= table_index;
    fetched <= fetch;
    fetched_bank <= ~bank;
    fetched_channel <= fetch_index[1:0];
    if (fetched) table_read_gain <= fetched_gain[fetched_channel];
    if (rst) begin
      valid_q <= '0;
      starts_q <= 1'b0;
      upper_q <= 1'b0;
      first_q2 <= 1'b1;
      segment_q <= 1'b0;
      segment_q2 <= 1'b0;
      segment_read_q <= 1'b0;
      segment_read_q2 <= 1'b0;
      node_done <= 1'b0;
      segment_done <= 1'b0;
      late <= 1'b0;
      fetched <= 1'b0;
    end
  end
  assign out_valid = valid_q[Latency-1];
  assign out_place = place_q[4*Latency-1-:4];

  // Each channel: weigh a node and the one below it, then run along the row from node to node.

  logic [Channels*SumWidth-1:0] sums;
  logic start, node_begins, between;
  assign start = start_q[ToSum-1];
  assign node_begins = begins_q[ToSum-1];
  assign between = inner_q[ToSum-1];
  for (genvar c = 0; c < Channels; c++) begin : g_along
    logic [SumWidth-1:0] sum, far, near;
    assign sum = sums[c*SumWidth+:SumWidth];
    logic signed [Width+ShareBits+2:0] product;
    multiply #(.AWidth(Width + 1), .BWidth(ShareBits + 2)) u_product (
      .clk, .en, .a({1'b0, used_gains[c*Width+:Width]}), .b({1'b0, weight_q}), .product
    );
    logic unused_signs;
    assign unused_signs = ^product[Width+ShareBits+2:SumWidth];
    logic signed [SumWidth:0] step;
    logic [GainWidth-1:0] gain, from;
    logic signed [GainWidth-1:0] add;
    logic signed [Width:0] rounded;
    logic unused_clipped, unused_sign;
    assign from = start ? {far, {ShareBits{1'b0}}} : node_begins & between ? {near, {ShareBits{1'b0}}} : gain;
    assign add = node_begins ? GainWidth'(step) : between ? GainWidth'(step) <<< 1 : '0;
    round_saturate #(.InWidth(GainWidth + 1), .Drop(2 * ShareBits), .OutWidth(Width + 1)) u_round (
      .in({1'b0, gain}), .out(rounded), .clipped(unused_clipped)
    );
    assign unused_sign = rounded[Width];
    always_ff @(posedge clk) begin
      if (en) begin
        // In this form: where the sum stands first, Yosys 0.70 packs it into a DSP48 with the choice inverted.
        sums[c*SumWidth+:SumWidth] <= (first_q2 ? '0 : sum) + product[SumWidth-1:0];
        if (node_done) far <= sum;
        if (segment_done) begin
          near <= far;
          step <= $signed({1'b0, sum}) - $signed({1'b0, far});
        end
        if (valid_q[ToSum]) gain <= from + $unsigned(add);
        out_gains[c*Width+:Width] <= rounded[Width-1:0];
      end
    end
  end

`ifndef SYNTHESIS
  initial begin
    if (BlockLog2 < 1) $fatal(1, "%m: BlockLog2 must be at least 1: a node is read in a clock, and two are needed");
    if (Columns != 1 << ColumnWidth) $fatal(1, "%m: Columns must be a power of two");
    if (NodeColumns < 2 || NodeRows < 1) $fatal(1, "%m: two blocks a row and one a column are needed");
  end
`endif

endmodule
