// SPDX-License-Identifier: Apache-2.0
// fv_td_block_sum: a sum is written 5 clocks behind the last word of a block's row, complete behind the last row of a last
// frame, and at no other time; an arbitrary word, the only one that is not zero since the first frame, is added once to
// its block and to no other; what does nothing but add does so to all. No sum is read before it was written, or in the
// clock that writes it.

parameter int Rows = 3, Columns = 4, Width = 2, SumWidth = 5, Signed = 1, ColumnLog2 = 1;
localparam int BlockLog2 = 1;
input logic [BlockWidth-1:0] chosen;

localparam int Wide = 1 << ColumnLog2, Blocks = (Rows / 2) * (Columns / Wide), ToSum = 5;

logic [SumWidth-1:0] sums;
assign read_sums = sums;
td_ram #(.Width(SumWidth), .Depth(Blocks)) u_ram (
  .clk, .write_en, .write_address(write_block), .write_data(write_sums),
  .read_en, .read_address(read_block), .read_data(sums)
);
ram_check #(.Depth(Blocks)) u_check (
  .clk, .write_en, .write_address(write_block), .read_en, .read_address(read_block)
);

wire [15:0] row = u_protocol.row, column = u_protocol.column;

logic row_ends, block_ends, last_q, last, fresh;
logic [BlockWidth-1:0] watched, block;
assign last = in_frame_start ? in_last_frame : last_q;
assign fresh = in_valid && in_frame_start && in_first_frame;
assign block = BlockWidth'(32'(row) / 2 * (Columns / Wide) + 32'(column) / Wide);
assign row_ends = in_valid && 32'(row) < Rows / 2 * 2 && 32'(column) % Wide == Wide - 1;
assign block_ends = row_ends && row[0] && last;

logic [ToSum-1:0] ends_q, completes_q;
logic [BlockWidth*ToSum-1:0] block_q;
logic seen, in_watched;
logic signed [SumWidth-1:0] word, total, held_sum;  // of the watched block: the one word, what the memory holds
assign in_watched = 32'(row) < Rows / 2 * 2 && block == watched;
assign word = Signed != 0 ? SumWidth'($signed(in_data)) : SumWidth'(in_data);
always_ff @(posedge clk) begin
  if (!started) watched <= chosen;
  if (in_valid) begin
    last_q <= last;
    seen <= in_data != '0 || (seen && !fresh);
    if (fresh || (in_watched && in_data != '0)) total <= in_watched ? word : '0;
  end
  if (write_en && write_block == watched) held_sum <= write_sums;
  ends_q <= {ends_q[ToSum-2:0], row_ends};
  completes_q <= {completes_q[ToSum-2:0], block_ends};
  block_q <= {block_q[BlockWidth*(ToSum-1)-1:0], block};
  if (rst) begin
    ends_q <= '0;
    completes_q <= '0;
  end
end
always_comb if (in_valid && seen && !fresh) assume (in_data == '0);

// The sum of the watched block is in its place, but for words that are under way.
logic [ToSum-1:0] under_way;
always_ff @(posedge clk) under_way <= rst ? '0 : {under_way[ToSum-2:0], in_valid && in_watched};

always_comb begin
  if (started) begin
    when: assert (write_en == ends_q[ToSum-1] && write_complete == completes_q[ToSum-1]);
    if (write_en) where: assert (write_block == block_q[BlockWidth*ToSum-1-:BlockWidth]);
    if (write_complete && write_block == watched && !fresh) begin
      if (under_way[ToSum-2:0] == '0) added_once: assert ($signed(write_sums) == total);
      several: cover (total != '0 && under_way == ToSum'(1) << (ToSum - 1));
      elsewhere: cover (seen && total == '0);
    end
    row_follows: cover (write_complete && in_valid);
  end
end

// Protocol: frames in raster order, whole but for a reset, the first after a reset begins new sums; whatever the
// memory answers.
module protocol_td_block_sum;
  logic [15:0] row, column;
  logic begun = 1'b0;
  logic [3:0] place;
  assign holds = rst | ~in_valid | begun | in_first_frame;
  always_ff @(posedge clk) begun <= ~reset & (begun | in_valid);
  raster_places #(.Rows(Rows), .Columns(Columns)) u_places (.*, .en(1'b1));
  assign given_in_frame_start = in_valid & ~rst ? &place[1:0] : in_frame_start;
  assign counts = live & ~reset;
  assign counts_read_block = counts & read_en;
  assign {counts_write_block, counts_write_sums} = {2{counts & write_en}};
endmodule
