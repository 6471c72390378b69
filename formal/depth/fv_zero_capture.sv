// SPDX-License-Identifier: Apache-2.0
// fv_zero_capture: a capture begins with the first frame behind a request, takes 2^k frames, and is done 7 clocks
// behind the last word of the last row of blocks; in the last frame each node is written once, 6 clocks behind the last
// word of its block, nothing else is, nothing while idle; no sum is read before it was written, or in the clock that
// writes it. In a second part (Sums 1): an arbitrary depth of a capture, the only one that is not zero, is added once
// to its node and to no other, and the zero offset of a node is its sum's mean, ties to even; what does nothing but add does
// so to all. With several lanes the first part is so for beats one clock after they came, and the depths of a beat that
// belong to one block are added up: then what is proven of one lane is so for their sum.

parameter int Rows = 3, Columns = 4, Width = 4, MaxLog2 = 1, Sums = 0, Lanes = 1;
localparam int BlockLog2 = 1;
input logic [NodeWidth-1:0] chosen;

localparam int SumWidth = Width + 2 + MaxLog2;
localparam int Clocks = 7;  // from the last word to done
localparam int ToMap = 6;   // from a block's last word to its zero offset

wire [15:0] row_in = u_protocol.row, column_in = u_protocol.column;
logic [15:0] row, column;

// With several lanes the two depths of a block in a beat are added up first.
logic take, frame_start;
if (Lanes > 1) begin : g_lanes
  logic [Lanes*Width-1:0] data_q;
  always_ff @(posedge clk) begin
    take <= en && in_valid && !rst;
    {frame_start, row, column, data_q} <= {in_frame_start, row_in, column_in, in_data};
  end
  for (genvar s = 0; s < Side; s++) begin : g_side
    logic signed [Width-1:0] left, right;
    assign {right, left} = data_q[2*s*Width+:2*Width];
    always_comb begin
      if (started && take) begin
        added_up: assert (dut.u_sum.in_data[s*(Width+1)+:Width+1] == (Width + 1)'(left) + (Width + 1)'(right));
      end
    end
  end
end else begin : g_lane
  assign take = en && in_valid;
  assign {frame_start, row, column} = {in_frame_start, row_in, column_in};
end
typedef enum logic [1:0] {Idle, Armed, Summing, Closing} state_e;
state_e state;
logic [NodeWidth-1:0] watched, node;  // chosen in the first clock, then constant; of the word that comes
logic [3:0] log2, log2_next;
logic [MaxLog2:0] wanted;  // frames to be summed yet
logic first, block_ends, last;
logic [2:0] to_done;
assign first = take && frame_start;
assign log2_next = 32'(log2_frames) > MaxLog2 ? 4'(MaxLog2) : log2_frames;
assign node = NodeWidth'(32'(row) / 2 * (Columns / 2 / Side) + 32'(column) * Lanes / (2 * Side));
assign block_ends = take && 32'(row) < Rows / 2 * 2 && row[0] && (column[0] || Lanes > 1);
assign last = block_ends && 32'(node) == Nodes - 1 && state == Summing && wanted == (MaxLog2 + 1)'(1);

// Nodes on their way to the map.
logic [ToMap-1:0] closes;
logic [NodeWidth*ToMap-1:0] closed_node;
logic written;  // the watched node, in this capture
always_ff @(posedge clk) begin
  if (!started) watched <= chosen;
  closes <= {closes[ToMap-2:0], block_ends && state == Summing && wanted == (MaxLog2 + 1)'(1)};
  closed_node <= {closed_node[NodeWidth*(ToMap-1)-1:0], node};
  if (first && state == Armed) begin
    state <= Summing;
    log2 <= log2_next;
    wanted <= (MaxLog2 + 1)'(1) << log2_next;
    written <= 1'b0;
  end
  if (map_write && map_write_node == watched) written <= 1'b1;
  if (block_ends && 32'(node) == Nodes - 1 && state == Summing) wanted <= wanted - (MaxLog2 + 1)'(1);
  if (last) begin
    state <= Closing;
    to_done <= 3'(Clocks - 1);
  end
  if (state == Closing) begin
    to_done <= to_done - 3'd1;
    if (to_done == '0) state <= Idle;
  end
  if (request) state <= Armed;
  if (rst) state <= Idle;
  if (rst || request) closes <= '0;
end

if (Sums == 0) begin : g_order
  always_comb begin
    if (started) begin
      when: assert (busy == (state != Idle) && done == (state == Closing && to_done == '0));
      written_when_due: assert (map_write == (closes[ToMap-1] && !rst));
      if (map_write) begin
        to_its_node: assert (map_write_node == closed_node[NodeWidth*ToMap-1-:NodeWidth]);
        in_last_frame: assert (state == Closing || state == Summing && wanted == (MaxLog2 + 1)'(1));
        if (map_write_node == watched) once: assert (!written);
      end
      if (done) each_written: assert (written);
      several: cover (done && log2 != '0);
      at_once: cover (done && log2 == '0 && first);
      afresh: cover (request && state == Closing && map_write);
      between: cover (first && state == Closing);
    end
  end
end else begin : g_sums
  logic in_watched, counts, seen, fresh;
  logic signed [Width-1:0] data, zero;
  logic signed [Width-1:0] depth;        // that of the watched node, in this capture; zero: it is not there
  logic signed [SumWidth-1:0] held_sum;  // of the watched node, as the memory holds it
  assign in_watched = 32'(row) < Rows / 2 * 2 && node == watched;
  assign data = in_data;
  assign zero = map_write_zero;
  assign fresh = first && state == Armed;
  assign counts = take && (state == Summing || fresh);
  always_comb if (counts && seen && !fresh) assume (data == '0);
  always_ff @(posedge clk) begin
    if (dut.u_sums.write_en && dut.u_sums.write_address == watched) held_sum <= dut.u_sums.write_data;
    if (counts) begin
      seen <= data != '0 || (seen && !fresh);
      if (fresh || (in_watched && data != '0)) depth <= in_watched ? data : '0;
    end
  end

  logic [3:0] bits;
  logic signed [Width:0] whole;
  logic [Width+2:0] share, half;  // what is cut off
  always_comb begin
    bits = 4'd2 + log2;
    whole = (Width + 1)'(depth) >>> bits;
    share = (Width + 3)'(depth) & (((Width + 3)'(1) << bits) - (Width + 3)'(1));
    half = (Width + 3)'(1) << (bits - 4'd1);
    if (share > half || (share == half && whole[0])) whole = whole + (Width + 1)'(1);
  end
  always_comb begin
    if (started && map_write && map_write_node == watched) begin
      added_once: assert (held_sum == SumWidth'(depth));
      mean: assert ((Width + 1)'(zero) == whole);
      tie_down: cover (share == half && whole == '0 && log2 != '0);
      tie_up: cover (share == half && whole < 0);
      elsewhere: cover (seen && depth == '0);
    end
  end
end

bind dut.u_sums.u_ram ram_check #(.Depth(Depth)) u_check (.*);
