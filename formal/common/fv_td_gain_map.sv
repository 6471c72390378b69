// SPDX-License-Identifier: Apache-2.0
// fv_td_gain_map: every gain is the interpolation, rounded to even, of the nodes of the bank that was named when its frame
// began; valid and data travel with it, 10 enabled clocks; while en is low all of them hold. An entry that is read is
// that of the bank not in use. In two parts: down a column (Along 0), the weighted sum of two nodes of the row that the
// pixel is in, of the right bank; along a row (Along 1), gains between any two such sums.
//
// One channel is looked at: all are one generate. Assumed: places in raster order; nothing is written, nor read by
// the capture, while a change-over is due; bus and capture one at a time.

`default_nettype none

module fv_td_gain_map #(
  parameter int Rows      = 5,
  parameter int Columns   = 4,
  parameter int BlockLog2 = 1,
  parameter int Latency   = 10,
  parameter int Along     = 0,
  parameter int Width     = 1,
  parameter int Channels  = 3,
  localparam int Channel = Channels / 2,
  localparam int Block = 1 << BlockLog2,
  localparam int NodeColumns = Columns / Block,
  localparam int NodeRows = Rows / Block,
  localparam int Nodes = NodeRows * NodeColumns,
  localparam int NodeWidth = $clog2(Nodes)
) (
  input logic                 clk,
  input logic                 rst,
  input logic                 en,
  input logic                 table_bank,
  input logic                 table_write,
  input logic                 table_read,
  input logic [NodeWidth+1:0] table_index,
  input logic [Width-1:0]     table_gain,
  input logic                 capture_write,
  input logic [NodeWidth-1:0] capture_write_node,
  input logic [Channels*Width-1:0] capture_gains,
  input logic                 capture_read,
  input logic [NodeWidth-1:0] capture_read_node,
  input logic                 in_valid,
  input logic                 in_frame_start,
  input logic                 in_data
);

  logic table_in_use, out_valid, out_data, active;
  logic [Width-1:0] table_read_gain;
  logic [Channels*Width-1:0] capture_read_gains, out_gains;
  td_gain_map #(.Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Width(Width), .Channels(Channels), .DataWidth(1)) dut (
    .clk, .rst, .en, .table_bank, .table_in_use, .table_write, .table_read, .table_index, .table_gain,
    .table_read_gain, .capture_write, .capture_write_node, .capture_gains, .capture_read, .capture_read_node,
    .capture_read_gains, .in_valid, .in_frame_start, .in_data, .out_valid, .out_data, .out_gains, .active
  );

  logic [3:0] row, column, position;
  raster_counter #(.Rows(Rows), .Columns(Columns)) u_raster (.clk, .rst, .en, .in_valid, .row, .column, .position);

  // Pixels on their way: the one that came n enabled clocks ago is in field n - 1.
  localparam int ToSum = 8;
  localparam int Share = 2 * Block;
  localparam int SumWidth = Width + BlockLog2 + 1;
  logic [8*ToSum-1:0] places_q;  // {row, column}

  logic bank, used, named, starts_q;
  assign used = starts_q ? named : bank;

  logic started = 1'b0;
  logic [1:0] read_left;  // clocks until what was read stands
  always_comb begin
    if (!started) assume (rst);
    if (in_valid) assume (in_frame_start == &position[1:0]);
    assume (32'(table_index[NodeWidth+1:2]) < Nodes);
    assume (32'(capture_write_node) < Nodes && 32'(capture_read_node) < Nodes);
    assume (!(capture_write && capture_read && capture_write_node == capture_read_node));
    if (rst || table_bank != table_in_use || used != bank || table_read || read_left != 0) begin
      assume (!table_write && !capture_write && !capture_read);
    end
    if (rst || read_left != 0) assume (!table_read);
    if (table_write) assume (!capture_write && !capture_read);
  end

  // The banks as they should be.
  logic [Width-1:0] words_0[Nodes], words_1[Nodes];
  initial begin
    $readmemh("gain_0.hex", words_0);
    $readmemh("gain_0.hex", words_1);
  end
  logic bus_writes;
  logic [Width-1:0] written;
  logic [NodeWidth-1:0] node_written;
  assign bus_writes = table_write && table_index[1:0] == 2'(Channel);
  assign written = capture_write ? capture_gains[Channel*Width+:Width] : table_gain;
  assign node_written = capture_write ? capture_write_node : table_index[NodeWidth+1:2];
  always_ff @(posedge clk) begin
    if (started && (capture_write || bus_writes)) begin
      if (bank) words_0[node_written] <= written;
      else words_1[node_written] <= written;
    end
  end

  logic [Latency-1:0] valid;
  logic held, read_known, changed;
  fixed_delay #(.Latency(Latency)) u_delay (
    .clk, .rst, .en, .in_valid, .in_data, .out_valid, .out_data, .active, .valid, .held
  );
  logic [Width-1:0] read_gain, out_q;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    out_q <= out_gains[Channel*Width+:Width];
    if (en) begin
      starts_q <= in_valid & in_frame_start;
      if (in_valid && in_frame_start) named <= table_bank;
      bank <= used;
    end
    if (started && !rst && bank != used && en) changed <= 1'b1;
    read_left <= table_read ? 2'd1 : read_left - 2'(read_left != 0);
    if (table_read) begin  // of the bank that is not in use behind this clock; the other channels: unknown
      read_known <= table_index[1:0] == 2'(Channel) || 32'(table_index[1:0]) >= Channels;
      read_gain <= 32'(table_index[1:0]) >= Channels ? '0
          : (en ? used : bank) ? words_0[table_index[NodeWidth+1:2]] : words_1[table_index[NodeWidth+1:2]];
    end
    if (rst) begin
      starts_q <= 1'b0;
      bank <= table_bank;
      read_left <= '0;
      read_known <= 1'b0;
      changed <= 1'b0;
    end
  end

  always_comb begin
    if (started) begin
      bank_in_use: assert (table_in_use == bank);
      if (held) holds: assert (out_gains[Channel*Width+:Width] == out_q);
      if (read_known && read_left == 0) entry: assert (table_read_gain == read_gain);
      new_frame_with_new_gains: cover (changed && out_valid && places_q[8*ToSum-1-:8] == '0 && out_gains[Channel*Width]);
      read_at_the_change: cover (table_read && bank != used && en);
    end
  end

  function automatic logic [7:0] clamped(input logic [3:0] at_pixel, input int nodes);
    int at;
    at = 2 * 32'(at_pixel) + 1 - Block;
    if (at < 0) at = 0;
    if (at > (nodes - 1) * Share) at = (nodes - 1) * Share;
    return 8'(at);
  endfunction
  function automatic logic ends(input logic [3:0] at_pixel);  // it is the first behind a node's centre
    return 32'(at_pixel) % Block == Block / 2 && 32'(at_pixel) < Columns - Block / 2;
  endfunction
  always_ff @(posedge clk) if (en) places_q <= {places_q[8*(ToSum-1)-1:0], row, column};
  logic [SumWidth-1:0] sum;
  assign sum = dut.sums[Channel*SumWidth+:SumWidth];

  if (Along == 0) begin : g_down
    // With the pixel that came two enabled clocks ago the bank of its frame is in use, and its rows do not change.
    logic [3:0] row_2, column_2;
    logic [7:0] y, x;
    logic [NodeWidth-1:0] node, node_below;
    logic [SumWidth-1:0] weight, first, second, weighted;
    logic [5*SumWidth-1:0] expected;
    assign {row_2, column_2} = places_q[15:8];
    always_comb begin
      y = clamped(row_2, NodeRows);
      x = ends(column_2) ? 8'(32'(column_2) / Block + 1) : '0;
      node = NodeWidth'(32'(y) / Share * NodeColumns + 32'(x));
      node_below = NodeWidth'(32'(node) + NodeColumns);
      weight = SumWidth'(32'(y) % Share);
      first = SumWidth'(bank ? words_1[node] : words_0[node]);
      second = weight == '0 ? '0 : SumWidth'(bank ? words_1[node_below] : words_0[node_below]);
      weighted = (SumWidth'(Share) - weight) * first + weight * second;
    end
    logic segment, start;
    assign segment = valid[6] && ends(places_q[51:48]);
    assign start = valid[5] && places_q[43:40] == '0;
    always_ff @(posedge clk) if (en) expected <= {expected[4*SumWidth-1:0], weighted};
    always_comb begin
      if (started) begin
        when: assert (dut.node_done == (segment || start) && dut.segment_done == segment && !(segment && start));
        if (segment) of_a_node: assert (sum == expected[4*SumWidth+:SumWidth]);
        if (start) of_the_first: assert (sum == expected[3*SumWidth+:SumWidth]);
        weighed: cover (segment && weight != '0 && sum == SumWidth'(Share - 1) && changed);
      end
    end
  end else begin : g_along
    // As the first part has it: a sum of two nodes is no larger than a whole of the largest gain.
    always_comb assume (sum <= SumWidth'(Share * ((1 << Width) - 1)));

    // Of the row: the sums at the first and the second node. The latter comes with the first pixel that needs it.
    localparam int GainWidth = SumWidth + BlockLog2 + 1;
    logic [SumWidth-1:0] left, right;
    logic [7:0] x;
    logic [GainWidth-1:0] whole, rounded_down;
    logic [Width-1:0] gain, gain_q, gain_q2;
    logic up;
    always_comb begin
      x = clamped(places_q[8*(ToSum-1)+:4], NodeColumns);
      whole = GainWidth'(Share - 32'(x)) * GainWidth'(left) + GainWidth'(x) * GainWidth'(right);
      if (32'(x) == Share) whole = GainWidth'(Share) * GainWidth'(right);
      rounded_down = whole >> (2 * BlockLog2 + 2);
      up = whole[2*BlockLog2+1] && (whole[2*BlockLog2:0] != '0 || rounded_down[0]);
      gain = Width'(rounded_down) + Width'(up);
    end
    always_ff @(posedge clk) begin
      if (en) begin
        if (dut.node_done && !dut.segment_done) left <= sum;
        if (dut.segment_done) right <= sum;
        gain_q <= gain;
        gain_q2 <= gain_q;
      end
    end
    always_comb begin
      if (started) begin
        if (out_valid) interpolated: assert (out_gains[Channel*Width+:Width] == gain_q2);
        tie: cover (out_valid && whole[2*BlockLog2+1:0] == (1 << (2 * BlockLog2 + 1)) && held);
      end
    end
  end

  bind fv_td_gain_map.dut.g_table[Channel].u_gains.g_bank[0].u_ram ram_check #(.Depth(Depth), .Defined(0)) u_check_0 (
    .clk, .write_en, .write_address, .read_en, .read_address
  );
  bind fv_td_gain_map.dut.g_table[Channel].u_gains.g_bank[1].u_ram ram_check #(.Depth(Depth), .Defined(0)) u_check_1 (
    .clk, .write_en, .write_address, .read_en, .read_address
  );

endmodule

`default_nettype wire
