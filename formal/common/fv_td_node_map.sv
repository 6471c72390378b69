// SPDX-License-Identifier: Apache-2.0
// fv_td_node_map: every word that leaves is the interpolation, rounded to even, of the nodes of the bank that was named when
// its frame began; valid and data travel with it, Latency enabled clocks; while en is low all of them hold. An entry that
// is read is that of the bank not in use. In two parts: down a column (Along 0), the weighted sum of two nodes of each
// column of a word, of the row that the beat is in and of the right bank; along a row (Along 1), an arbitrary pixel of a
// beat between any such sums.
//
// Assumed: beats in raster order, whole frames but for a reset; nothing is written while a change-over is due; bus and
// capture one at a time.

`default_nettype none

module fv_td_node_map #(
  parameter int Rows      = 5,
  parameter int Columns   = 8,
  parameter int BlockLog2 = 1,
  parameter int Lanes     = 2,
  parameter int Latency   = 10,
  parameter int Along     = 0,
  parameter int Width     = 1,
  localparam int Block = 1 << BlockLog2,
  localparam int NodeColumns = Columns / Block,
  localparam int NodeRows = Rows / Block,
  localparam int Nodes = NodeRows * NodeColumns,
  localparam int NodeWidth = $clog2(Nodes),
  localparam int Side = Lanes > Block ? Lanes / Block : 1
) (
  input logic                 clk,
  input logic                 rst,
  input logic                 en,
  input logic                 table_bank,
  input logic                 table_write,
  input logic                 table_read,
  input logic [NodeWidth-1:0] table_index,
  input logic [Width-1:0]     table_zero,
  input logic                 capture_write,
  input logic [NodeWidth-$clog2(Side)-1:0] capture_write_node,
  input logic [Side*Width-1:0] capture_zeros,
  input logic                 in_valid,
  input logic                 in_frame_start,
  input logic                 in_data,
  input logic [$clog2(Lanes)-1:0] choose  // the pixel of each beat that is followed
);

  localparam int Beats = Columns / Lanes;                     // of a row
  localparam int BeatsOfBlock = Lanes < Block ? Block / Lanes : 1;
  localparam int Ahead = BeatsOfBlock > 1 ? BeatsOfBlock / 2 : 1;
  localparam int Words = NodeColumns / Side;                  // of a row
  localparam int ToFirst = 6, ToNext = 7;                     // from a beat to the sums of a row's first word, of the next
  localparam int ToUse = 3;                                   // to the clock from which on the bank of its frame is in use
  localparam int Share = 2 * Block;
  localparam int SumWidth = Width + BlockLog2 + 1;

  logic table_in_use, out_valid, out_data, active;
  logic [Width-1:0] table_read_zero;
  logic [Lanes*Width-1:0] out_zeros;
  td_node_map #(.Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Width(Width), .Lanes(Lanes), .DataWidth(1)) dut (
    .clk, .rst, .en, .table_bank, .table_in_use, .table_write, .table_read, .table_index, .table_zero,
    .table_read_zero, .capture_write, .capture_write_node, .capture_zeros, .in_valid, .in_frame_start, .in_data,
    .out_valid, .out_data, .out_zeros, .active
  );

  logic [3:0] row, beat, position;
  raster_counter #(.Rows(Rows), .Columns(Beats)) u_raster (.clk, .rst, .en, .in_valid, .row, .column(beat), .position);

  logic started = 1'b0;
  logic [1:0] read_left;  // clocks until what was read stands
  logic bank, named;
  logic [1:0] starts_q;
  always_comb begin
    if (!started) assume (rst);
    if (in_valid) assume (in_frame_start == &position[1:0]);
    assume (32'(table_index) < Nodes && 32'(capture_write_node) < Nodes / Side);
    if (rst || table_bank != table_in_use || named != table_in_use || table_read || read_left != 0) begin
      assume (!table_write && !capture_write);
    end
    if (rst || read_left != 0) assume (!table_read);
    if (table_write) assume (!capture_write);
  end

  // The banks as they should be.
  logic [Width-1:0] words_0[Nodes], words_1[Nodes];
  initial begin
    $readmemh("nodes.hex", words_0);
    $readmemh("nodes.hex", words_1);
  end
  always_ff @(posedge clk) begin
    for (int n = 0; n < Nodes; n++) begin
      if (started && (capture_write ? 32'(capture_write_node) == n / Side : table_write && 32'(table_index) == n)) begin
        if (bank) words_0[n] <= capture_write ? capture_zeros[n%Side*Width+:Width] : table_zero;
        else words_1[n] <= capture_write ? capture_zeros[n%Side*Width+:Width] : table_zero;
      end
    end
  end

  logic [Latency-1:0] valid;
  logic held, read_known, changed, used;
  fixed_delay #(.Latency(Latency)) u_delay (
    .clk, .rst, .en, .in_valid, .in_data, .out_valid, .out_data, .active, .valid, .held
  );
  logic [Width-1:0] read_zero;
  logic [Lanes*Width-1:0] out_q;
  assign used = starts_q[1] ? named : bank;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    out_q <= out_zeros;
    if (en) begin
      starts_q <= {starts_q[0], in_valid & in_frame_start};
      if (in_valid && in_frame_start) named <= table_bank;
      bank <= used;
    end
    if (started && !rst && bank != used && en) changed <= 1'b1;
    read_left <= table_read ? 2'd1 : read_left - 2'(read_left != 0);
    if (table_read) begin  // of the bank that is not in use behind this clock
      read_known <= 1'b1;
      read_zero <= (en ? used : bank) ? words_0[table_index] : words_1[table_index];
    end
    if (rst) begin
      starts_q <= '0;
      bank <= table_bank;
      named <= table_bank;
      read_left <= '0;
      read_known <= 1'b0;
      changed <= 1'b0;
    end
  end

  always_comb begin
    if (started) begin
      bank_in_use: assert (table_in_use == bank);
      if (held) holds: assert (out_zeros == out_q);
      if (read_known && read_left == 0) entry: assert (table_read_zero == read_zero);
      new_frame_with_new_words: cover (changed && out_valid && out_zeros[0] && out_data);
      read_at_the_change: cover (table_read && bank != used && en);
    end
  end

  // Beats on their way: the one that came n enabled clocks ago is in field n - 1.
  logic [8*ToNext-1:0] places_q;  // {row, beat}
  function automatic logic [7:0] clamped(input int at_pixel, input int nodes);
    int at;
    at = 2 * at_pixel + 1 - Block;
    if (at < 0) at = 0;
    if (at > (nodes - 1) * Share) at = (nodes - 1) * Share;
    return 8'(at);
  endfunction
  function automatic logic reads(input logic [3:0] at_beat);  // the word behind its own, from here on
    return (32'(at_beat) + Ahead) % BeatsOfBlock == 0 && (32'(at_beat) + Ahead) / BeatsOfBlock < Words;
  endfunction
  always_ff @(posedge clk) if (en) places_q <= {places_q[8*(ToNext-1)-1:0], row, beat};
  logic first, next;
  assign first = valid[ToFirst-1] && places_q[8*(ToFirst-1)+:4] == '0;
  assign next = valid[ToNext-1] && reads(places_q[8*(ToNext-1)+:4]);

  if (Along == 0) begin : g_down
    logic [3:0] row_3, beat_3;
    logic [7:0] y;
    logic [SumWidth-1:0] weight;
    logic [2*Side*SumWidth-1:0] weighted;  // of the next word, of the first one
    logic [2*Side*SumWidth*(ToNext-ToUse)-1:0] weighted_q;
    assign {row_3, beat_3} = places_q[8*ToUse-1-:8];
    always_comb begin
      y = clamped(32'(row_3), NodeRows);
      weight = SumWidth'(32'(y) % Share);
      for (int n = 0; n < 2 * Side; n++) begin
        logic [NodeWidth-1:0] node, below;
        node = NodeWidth'(32'(y) / Share * NodeColumns + n % Side);
        if (n >= Side && reads(beat_3)) node = node + NodeWidth'((32'(beat_3) + Ahead) / BeatsOfBlock * Side);
        below = weight == '0 ? node : NodeWidth'(32'(node) + NodeColumns);
        weighted[n*SumWidth+:SumWidth] = (SumWidth'(Share) - weight) * SumWidth'(bank ? words_1[node] : words_0[node])
            + weight * SumWidth'(bank ? words_1[below] : words_0[below]);
      end
    end
    always_ff @(posedge clk) begin
      if (en) weighted_q <= {weighted_q[2*Side*SumWidth*(ToNext-ToUse-1)-1:0], weighted};
    end
    always_comb begin
      if (started) begin
        when: assert (dut.start_q[ToFirst-2] == first && dut.segment_q[ToNext-2] == next && !(first && next));
        if (first) of_the_first: assert (dut.sums == weighted_q[2*Side*SumWidth*(ToFirst-ToUse-1)+:Side*SumWidth]);
        if (next) of_the_next: assert (dut.sums == weighted_q[2*Side*SumWidth*(ToNext-ToUse)-1-:Side*SumWidth]);
        weighed: cover (next && weight != '0 && dut.sums[SumWidth-1:0] == SumWidth'(Share - 1) && changed);
      end
    end
  end else begin : g_along
    // As the first part has it: a sum of two nodes is no larger than a whole of the largest word.
    for (genvar s = 0; s < Side; s++) begin : g_sum
      always_comb assume (dut.sums[s*SumWidth+:SumWidth] <= SumWidth'(Share * ((1 << Width) - 1)));
    end

    // The sums of the row so far, and the chosen pixel of the beat between them.
    localparam int ZeroWidth = SumWidth + BlockLog2 + 1;
    localparam int Behind = Latency - ToNext;
    logic [NodeColumns*SumWidth-1:0] sums, sums_q;
    logic [$clog2(Lanes)-1:0] chosen;
    logic [3:0] beat_7;
    logic [7:0] x;
    logic [SumWidth-1:0] left, right;
    logic [ZeroWidth-1:0] whole;
    logic [Width-1:0] zero;
    logic up;
    logic [Behind*Width-1:0] zero_q;
    logic [Behind*ZeroWidth-1:0] whole_q;
    assign beat_7 = places_q[8*(ToNext-1)+:4];
    always_comb begin
      sums = sums_q;
      for (int n = 0; n < NodeColumns; n++) begin
        if (next && 32'(beat_7) + Ahead == n / Side * BeatsOfBlock) begin
          sums[n*SumWidth+:SumWidth] = dut.sums[n%Side*SumWidth+:SumWidth];
        end
      end
      x = clamped(32'(beat_7) * Lanes + 32'(chosen), NodeColumns);
      left = SumWidth'(sums >> 32'(x) / Share * SumWidth);
      right = 32'(x) % Share == 0 ? left : SumWidth'(sums >> (32'(x) / Share + 1) * SumWidth);
      whole = ZeroWidth'(Share - 32'(x) % Share) * ZeroWidth'(left) + ZeroWidth'(32'(x) % Share) * ZeroWidth'(right);
      up = whole[2*BlockLog2+1] && (whole[2*BlockLog2:0] != '0 || whole[2*BlockLog2+2]);
      zero = Width'(whole >> (2 * BlockLog2 + 2)) + Width'(up);
    end
    always_ff @(posedge clk) begin
      if (!started) chosen <= choose;
      if (en) begin
        sums_q <= sums;
        if (first) sums_q[Side*SumWidth-1:0] <= dut.sums;
        zero_q <= (Behind * Width)'({zero_q, zero});
        whole_q <= (Behind * ZeroWidth)'({whole_q, whole});
      end
    end
    always_comb begin
      if (started) begin
        if (out_valid) begin
          interpolated: assert (Width'(out_zeros >> 32'(chosen) * Width) == zero_q[Behind*Width-1-:Width]);
        end
        tie: cover (out_valid && whole_q[(Behind-1)*ZeroWidth+:2*BlockLog2+2] == (1 << (2 * BlockLog2 + 1)) && held);
      end
    end
  end

  bind fv_td_node_map.dut.g_node[0].g_table[0].u_zeros.g_bank[0].u_ram ram_check #(
    .Depth(Depth), .Defined(0)
  ) u_check_0 (.clk, .write_en, .write_address, .read_en, .read_address);
  bind fv_td_node_map.dut.g_node[0].g_table[0].u_zeros.g_bank[1].u_ram ram_check #(
    .Depth(Depth), .Defined(0)
  ) u_check_1 (.clk, .write_en, .write_address, .read_en, .read_address);
  bind fv_td_node_map.dut.g_node[Side-1].g_table[1].u_zeros.g_bank[0].u_ram ram_check #(
    .Depth(Depth), .Defined(0)
  ) u_check_2 (.clk, .write_en, .write_address, .read_en, .read_address);
  bind fv_td_node_map.dut.g_node[Side-1].g_table[1].u_zeros.g_bank[1].u_ram ram_check #(
    .Depth(Depth), .Defined(0)
  ) u_check_3 (.clk, .write_en, .write_address, .read_en, .read_address);

endmodule

`default_nettype wire
