// SPDX-License-Identifier: Apache-2.0
// reference_capture: the gains of gain_map from frames without contact.
//
//   gain = min(((2^(GainFraction + 1) n / S) + 1) >> 1, 2^Width - 1),  S the sum of n pixels: a block, in 2^k frames
//
// `request` starts it, at any time, afresh if it is busy. From the next start of frame on it sums each block and
// channel over 2^k whole frames, k = log2_frames at that start, at most MaxLog2; in_bad with a frame's last pixel
// starts it afresh. Then a serial divider turns each sum into its gain, 85 clocks a node. All this in the bank of
// gain_map that is not in use; `done` is high for one clock after the last gain is written, and asks for the
// change-over. While busy nobody else writes that bank, nor asks for a change-over.
// Stream in: pixels R in 23:16, B in 15:8, G in 7:0, the same that gain_map takes; gaps and en low change no gain.
// From the last pixel to done: 85 nodes + 2 clocks, en or not. Model:
// models/tactile_depth/calibration/reference_capture.py.

module reference_capture #(
  parameter int Rows         = 128,
  parameter int Columns      = 128,
  parameter int BlockLog2    = 3,
  parameter int Width        = 24,  // of a gain, and of a sum
  parameter int GainFraction = 27,
  parameter int MaxLog2      = 8,   // of frames: 8 + 2 BlockLog2 + MaxLog2 bits fit a sum
  localparam int NodeColumns = Columns / (1 << BlockLog2),
  localparam int NodeRows = Rows / (1 << BlockLog2),
  localparam int NodeWidth = $clog2(NodeRows * NodeColumns)
) (
  input  logic                 clk,
  input  logic                 rst,
  input  logic                 en,
  input  logic                 request,
  input  logic [3:0]           log2_frames,
  output logic                 busy,
  output logic                 done,

  input  logic                 in_valid,
  input  logic [23:0]          in_pixel,
  input  logic [3:0]           in_place,  // in the first row, first column, last row, last column
  input  logic                 in_bad,

  output logic                 map_write,
  output logic [NodeWidth-1:0] map_write_node,
  output logic [3*Width-1:0]   map_write_gains,
  output logic                 map_read,
  output logic [NodeWidth-1:0] map_read_node,
  input  logic [3*Width-1:0]   map_read_gains
);

  localparam int ColumnWidth = $clog2(Columns);
  localparam int RowWidth = $clog2(Rows) + 1;
  localparam int RowSumWidth = 8 + BlockLog2;
  localparam int LastNode = NodeRows * NodeColumns - 1;
  localparam int Bits = Width + 1;  // of a quotient, before the last is rounded off
  localparam int Whole = GainFraction + 1 + 2 * BlockLog2 - Bits;  // the dividend is 2^(Whole + k + Bits)

  localparam int LeftWidth = MaxLog2 > 0 ? MaxLog2 : 1;

  localparam logic [1:0] Idle = 2'd0, Armed = 2'd1, Summing = 2'd2, Dividing = 2'd3;
  logic [1:0] state;
  logic [3:0] log2, log2_next;
  logic [LeftWidth-1:0] left;  // whole frames to come
  logic take, starts, ends, last;
  assign take = en & in_valid;
  assign starts = take & in_place[0] & in_place[1] & (state == Armed | state == Summing);
  assign ends = take & in_place[2] & in_place[3] & state == Summing;
  assign last = ends & ~in_bad & left == '0;
  assign log2_next = log2_frames > 4'($unsigned(MaxLog2)) ? 4'(MaxLog2) : log2_frames;
  assign busy = state != Idle | done;

  // Sums. A block's row of pixels is added up, then added to what its node holds, or in the block's first row of the
  // first frame to nothing. The last clock of one such addition is the first of the next at the earliest.

  logic summing_q, fresh, row_ends, row_ends_q2, begin_sum, begin_sum_q2;
  logic row_ends_q3 = 1'b0;  // a clock before the first reset writes no gain
  logic [ColumnWidth-1:0] column;
  logic [RowWidth-1:0] row;
  logic [23:0] colours_q;
  logic [NodeWidth-1:0] node, node_q, node_q2, node_q3;
  assign row_ends = summing_q & column[BlockLog2-1:0] == '1 & row < RowWidth'($unsigned(NodeRows << BlockLog2));
  assign begin_sum = fresh & row[BlockLog2-1:0] == '0;
  assign node = NodeWidth'({row[RowWidth-1:BlockLog2], column[ColumnWidth-1:BlockLog2]});

  logic begin_sum_q, row_ends_q;
  logic [3*Width-1:0] sums;
  for (genvar c = 0; c < 3; c++) begin : g_sum
    logic [RowSumWidth-1:0] row_sum, row_sum_q;
    logic [Width-1:0] sum;
    assign sums[c*Width+:Width] = sum;
    always_ff @(posedge clk) begin
      if (summing_q) begin
        row_sum <= (column[BlockLog2-1:0] == '0 ? '0 : row_sum) + RowSumWidth'(colours_q[8*c+:8]);
      end
      row_sum_q <= row_sum;
      sum <= (begin_sum_q2 ? '0 : map_read_gains[c*Width+:Width]) + Width'(row_sum_q);
    end
  end

  // The divider: one bit of a quotient a clock, channel by channel. Phase 3 is that of the memory; its first clocks let
  // the last sum be written.

  localparam int StepWidth = $clog2(Bits + 2);
  localparam int ReadStep = 2;
  logic [StepWidth-1:0] step;
  logic [1:0] phase;
  logic [NodeWidth-1:0] divide_node;
  logic [3*Width-1:0] word;
  logic [Width-1:0] divisor, remainder, gain;
  logic [Whole+MaxLog2:0] whole;
  logic [Width:0] twice;
  logic [Bits-1:0] quotient;
  logic overflow, bit_set, reading, node_ends, divided;
  logic write_back = 1'b0;
  assign divisor = word[Width-1:0];
  assign whole = (Whole + MaxLog2 + 1)'(1) << (StepWidth'(log2) + StepWidth'(Whole));
  // With a divisor over `whole` the quotient stays so far below 2^Bits that rounding does not carry out.
  assign twice = {remainder, 1'b0};
  assign bit_set = twice >= {1'b0, divisor};
  assign gain = overflow ? '1 : quotient[Bits-1:1] + Width'(quotient[0]);
  assign reading = state == Dividing & phase == 2'd3 & step == StepWidth'(ReadStep);
  assign node_ends = state == Dividing & phase == 2'd2 & step == StepWidth'(Bits + 1);
  assign divided = write_back & divide_node == NodeWidth'(LastNode);

  assign map_read = (row_ends_q & ~begin_sum_q) | reading;
  assign map_read_node = reading ? divide_node : node_q;
  assign map_write = (row_ends_q3 | write_back) & ~rst;  // at power-up neither is known, nor which bank is free
  assign map_write_node = write_back ? divide_node : node_q3;
  assign map_write_gains = write_back ? word : sums;

  always_ff @(posedge clk) begin
    summing_q <= take & (state == Summing | starts);
    if (take) begin
      column <= in_place[1] ? '0 : column + ColumnWidth'(1);
      if (in_place[1]) row <= in_place[0] ? '0 : row + RowWidth'(1);
      colours_q <= {in_pixel[15:8], in_pixel[7:0], in_pixel[23:16]};
    end
    row_ends_q <= row_ends;
    row_ends_q2 <= row_ends_q;
    row_ends_q3 <= row_ends_q2;
    begin_sum_q <= begin_sum;
    begin_sum_q2 <= begin_sum_q;
    node_q <= node;
    node_q2 <= node_q;
    node_q3 <= node_q2;

    if (state == Dividing) begin
      step <= step + StepWidth'(1);
      if (phase == 2'd3 && step == StepWidth'(ReadStep + 1)) begin
        word <= map_read_gains;
        phase <= 2'd0;
        step <= '0;
      end
      if (step == StepWidth'(Bits + 1)) begin
        word <= {gain, word[3*Width-1:Width]};
        phase <= phase + 2'd1;
        step <= '0;
      end
      if (step == '0) begin
        remainder <= Width'(whole);
        overflow <= Width'(whole) >= divisor;
      end else begin
        remainder <= Width'(bit_set ? twice - {1'b0, divisor} : twice);
        quotient <= {quotient[Bits-2:0], bit_set};
      end
    end
    write_back <= node_ends;
    if (write_back) divide_node <= divide_node + NodeWidth'(1);

    if (starts) begin
      state <= Summing;
      fresh <= state == Armed;
      if (state == Armed) begin
        log2 <= log2_next;
        left <= (LeftWidth'(1) << log2_next) - LeftWidth'(1);  // with MaxLog2: all ones
      end
    end
    if (ends) begin
      left <= left - LeftWidth'(1);
      if (in_bad) state <= Armed;
    end
    if (last) begin
      state <= Dividing;
      phase <= 2'd3;
      step <= '0;
      divide_node <= '0;
    end
    done <= divided;
    if (divided) state <= Idle;
    if (request) begin
      state <= Armed;
      write_back <= 1'b0;
      done <= 1'b0;
    end
    if (rst) begin
      state <= Idle;
      done <= 1'b0;
      summing_q <= 1'b0;
      row_ends_q <= 1'b0;
      row_ends_q2 <= 1'b0;
      row_ends_q3 <= 1'b0;
      write_back <= 1'b0;
    end
  end

`ifndef SYNTHESIS
  initial begin
    if (BlockLog2 < 1) $fatal(1, "%m: BlockLog2 must be at least 1: an addition takes two clocks");
    if (Columns != 1 << ColumnWidth) $fatal(1, "%m: Columns must be a power of two");
    if (NodeColumns < 2 || NodeRows < 1) $fatal(1, "%m: two blocks a row and one a column are needed");
    if (8 + 2 * BlockLog2 + MaxLog2 > Width) $fatal(1, "%m: a sum over 2^MaxLog2 frames must fit Width bits");
    if (Whole < 0) $fatal(1, "%m: GainFraction + 2 BlockLog2 must be at least Width");
  end
`endif

endmodule
