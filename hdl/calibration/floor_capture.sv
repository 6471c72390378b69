// SPDX-License-Identifier: Apache-2.0
// floor_capture: the floor of auto_zero from frames of depth without contact.
//
//   floor = round( S / 2^(2 BlockLog2 + k) ),  S the sum of the depths of a block in 2^k frames, ties to even
//
// `request` starts it, at any time, afresh if it is busy. From the next frame on it sums each block over 2^k frames,
// k = log2_frames at that start, at most MaxLog2; during the last of them each node's floor goes into the bank of
// auto_zero that is not in use. `done` is high for one clock after the last, and asks for the change-over. While busy
// nobody else writes that bank, nor asks for a change-over.
// Stream in: frames of depth before the floor is taken off, whole but for a reset; gaps and en low change no floor.
// From the last word of the last row of blocks to done: 6 clocks, en or not. Model:
// models/tactile_depth/calibration/floor_capture.py.

module floor_capture #(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Width     = 24,
  parameter int MaxLog2   = 8,   // of frames
  localparam int NodeColumns = Columns / (1 << BlockLog2),
  localparam int NodeRows = Rows / (1 << BlockLog2),
  localparam int NodeWidth = $clog2(NodeRows * NodeColumns)
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    en,
  input  logic                    request,
  input  logic [3:0]              log2_frames,
  output logic                    busy,
  output logic                    done,

  input  logic                    in_valid,
  input  logic                    in_user,       // with the first word of a frame
  input  logic                    in_last,       // with the last of a row
  input  logic                    in_frame_end,  // with the last of a frame
  input  logic signed [Width-1:0] in_data,

  output logic                    map_write,
  output logic [NodeWidth-1:0]    map_write_node,
  output logic signed [Width-1:0] map_write_floor
);

  localparam int ColumnWidth = $clog2(Columns);
  localparam int RowWidth = $clog2(Rows) + 1;
  localparam int RowSumWidth = Width + BlockLog2;
  localparam int Drop = 2 * BlockLog2 + MaxLog2;
  localparam int SumWidth = Width + Drop;
  localparam int Nodes = NodeRows * NodeColumns;

  localparam int LeftWidth = MaxLog2 > 0 ? MaxLog2 : 1;

  localparam logic [1:0] Idle = 2'd0, Armed = 2'd1, Summing = 2'd2;
  logic [1:0] state;
  logic [3:0] log2, log2_next;
  logic [LeftWidth-1:0] left, left_next;  // frames to come after this one
  logic take, begins;
  assign take = en & in_valid;
  assign begins = take & in_user & state == Armed;
  assign log2_next = log2_frames > 4'($unsigned(MaxLog2)) ? 4'(MaxLog2) : log2_frames;
  assign left_next = begins ? (LeftWidth'(1) << log2_next) - LeftWidth'(1) : left;  // with MaxLog2: all ones
  assign busy = state != Idle | done;

  // A block's row of depths is added up, then added to its node's sum, or in the block's first row of the first frame
  // to nothing. The last clock of one such addition is the first of the next at the earliest.

  logic summing_q, fresh, final_frame, row_ended, row_ends, begin_sum, closes, closed;
  logic row_ends_q, row_ends_q2, begin_sum_q, begin_sum_q2, closes_q, closes_q2, closes_q3;
  logic row_ends_q3 = 1'b0;  // a clock before the first reset writes nothing
  logic write_back = 1'b0;
  logic [ColumnWidth-1:0] column;
  logic [RowWidth-1:0] row;
  logic [NodeWidth-1:0] node, node_q, node_q2, node_q3;
  assign row_ends = summing_q & column[BlockLog2-1:0] == '1 & row < RowWidth'($unsigned(NodeRows << BlockLog2));
  assign begin_sum = fresh & row[BlockLog2-1:0] == '0;
  assign closes = final_frame & row[BlockLog2-1:0] == '1;
  assign node = NodeWidth'({row[RowWidth-1:BlockLog2], column[ColumnWidth-1:BlockLog2]});

  logic signed [Width-1:0] data_q;
  logic signed [Width:0] mean;  // which Width bits hold
  logic signed [RowSumWidth-1:0] row_sum, row_sum_q;
  logic signed [SumWidth-1:0] sum, sum_read, scaled;
  logic unused_clipped, unused_sign;
  ram #(.Width(SumWidth), .Depth(Nodes), .Style(1)) u_sums (
    .clk, .write_en(row_ends_q3), .write_address(node_q3), .write_data(sum),
    .read_en(row_ends_q & ~begin_sum_q), .read_address(node_q), .read_data(sum_read)
  );
  assign closed = write_back & map_write_node == NodeWidth'(Nodes - 1);
  assign map_write = write_back & ~rst;  // at power-up it is not known which bank is free
  assign scaled = sum <<< (4'($unsigned(MaxLog2)) - log2);
  round_saturate #(.InWidth(SumWidth), .Drop(Drop), .OutWidth(Width + 1)) u_round (
    .in(scaled), .out(mean), .clipped(unused_clipped)
  );
  assign unused_sign = mean[Width];

  always_ff @(posedge clk) begin
    summing_q <= take & (state == Summing | begins);
    if (take) begin
      row_ended <= in_last;
      column <= in_user ? '0 : column + ColumnWidth'(1);
      row <= in_user ? '0 : row + RowWidth'(row_ended);
      data_q <= in_data;
      final_frame <= left_next == '0;
    end
    if (summing_q) row_sum <= (column[BlockLog2-1:0] == '0 ? '0 : row_sum) + RowSumWidth'(data_q);
    row_sum_q <= row_sum;
    sum <= (begin_sum_q2 ? '0 : sum_read) + SumWidth'(row_sum_q);
    row_ends_q <= row_ends;
    row_ends_q2 <= row_ends_q;
    row_ends_q3 <= row_ends_q2;
    begin_sum_q <= begin_sum;
    begin_sum_q2 <= begin_sum_q;
    closes_q <= closes;
    closes_q2 <= closes_q;
    closes_q3 <= closes_q2;
    node_q <= node;
    node_q2 <= node_q;
    node_q3 <= node_q2;
    write_back <= row_ends_q3 & closes_q3;
    map_write_node <= node_q3;
    map_write_floor <= mean[Width-1:0];

    if (begins) begin
      state <= Summing;
      log2 <= log2_next;
      left <= left_next;
    end
    if (take && in_user) fresh <= begins;
    // After the last one all ones again: what follows before done is written nowhere.
    if (take && in_frame_end) left <= left - LeftWidth'(1);
    done <= closed;
    if (closed) state <= Idle;
    if (request) state <= Armed;
    if (rst) state <= Idle;
    if (request || rst) begin
      summing_q <= 1'b0;
      row_ends_q <= 1'b0;
      row_ends_q2 <= 1'b0;
      row_ends_q3 <= 1'b0;
      write_back <= 1'b0;
      done <= 1'b0;
    end
  end

`ifndef SYNTHESIS
  initial begin
    if (BlockLog2 < 1) $fatal(1, "%m: BlockLog2 must be at least 1: an addition takes two clocks");
    if (Columns != 1 << ColumnWidth) $fatal(1, "%m: Columns must be a power of two");
    if (NodeColumns < 2 || NodeRows < 1) $fatal(1, "%m: two blocks a row and one a column are needed");
    if (MaxLog2 > 8) $fatal(1, "%m: MaxLog2 must be at most 8");
  end
`endif

endmodule
