// SPDX-License-Identifier: Apache-2.0
// fv_td_node_map: every word that leaves is the interpolation, rounded to even, of the nodes of the bank that was named
// when its frame began; valid and data travel with it, Latency enabled clocks; while en is low all of them hold. A word
// that bus or capture read is that of the bank not in use. In two parts: down a column (Along 0), the weighted sum of
// two nodes of each column of a word, of the row that the beat is in and of the right bank; along a row (Along 1), an
// arbitrary pixel of a beat between any such sums.
//
// One channel is looked at: all are one generate.

parameter int Rows = 5, Columns = 8, BlockLog2 = 1, Lanes = 2, Latency = 10, Along = 0, Width = 1, Signed = 0,
    Channels = 1;
localparam int LaneWidth = Lanes > 1 ? $clog2(Lanes) : 1, DataWidth = 1;
input logic [LaneWidth-1:0] choose;  // the pixel of each beat that is followed

localparam int Channel = Channels / 2, ChannelLog2 = $clog2(Channels), Block = 1 << BlockLog2,
    NodeColumns = Columns / Block, NodeRows = Rows / Block, Nodes = NodeRows * NodeColumns, NumberWidth = $clog2(Nodes),
    IndexWidth = NumberWidth + ChannelLog2, Tables = Lanes < Block ? 1 : 2;
localparam int Beats = Columns / Lanes;                     // of a row
localparam int BeatsOfBlock = Lanes < Block ? Block / Lanes : 1, Ahead = BeatsOfBlock > 1 ? BeatsOfBlock / 2 : 1;
localparam int Words = NodeColumns / Side;                  // of a row
localparam int ToFirst = 6, ToNext = 7;                     // from a beat to the sums of a row's first word, of the next
localparam int ToUse = 3;                                   // to the clock from which on the bank of its frame is in use
localparam int Share = 2 * Block, SumWidth = Width + BlockLog2 + 1;

table_answer_t expected_answer;

// The accesses that reach the table, and the answer to them (fv_td_table_port).
logic table_write, table_read;
logic [IndexWidth-1:0] table_index;
logic [NumberWidth-1:0] table_node;
logic [ChannelLog2:0] table_channel;
logic [Width-1:0] table_word, read_word;
assign table_node = NumberWidth'(table_index >> ChannelLog2);
assign table_channel = (ChannelLog2 + 1)'(32'(table_index) % (1 << ChannelLog2));
td_table_port #(.IndexWidth(IndexWidth), .Width(Width), .Signed(Signed)) u_port (
  .clk, .rst, .table_command, .table_answer(expected_answer), .write(table_write), .read(table_read),
  .index(table_index), .word(table_word), .free_word(read_word)
);

wire [15:0] row = u_protocol.row, beat = u_protocol.column;

logic [1:0] read_left;  // clocks until what was read stands
logic bank, named;
logic [1:0] starts_q;

// The banks as they should be.
logic [Width-1:0] words_0[Nodes], words_1[Nodes];
logic bus_writes;
assign bus_writes = table_write && table_channel == (ChannelLog2 + 1)'(Channel);
initial begin
  $readmemh("channel.hex", words_0);
  $readmemh("channel.hex", words_1);
end
always_ff @(posedge clk) begin
  for (int n = 0; n < Nodes; n++) begin
    logic [Width-1:0] written;
    written = capture_write ? capture_words[(n%Side*Channels+Channel)*Width+:Width] : table_word;
    if (started && (capture_write ? 32'(capture_write_node) == n / Side : bus_writes && 32'(table_node) == n)) begin
      if (bank) words_0[n] <= written;
      else words_1[n] <= written;
    end
  end
end

logic [Latency-1:0] valid;
logic held, read_known, changed, used, captured;
logic [Side-1:0][Width-1:0] captured_words, captured_now;
fixed_delay #(.Latency(Latency)) u_delay (.*);
logic [Lanes*Width-1:0] out, out_q;  // of the channel
for (genvar lane = 0; lane < Lanes; lane++) begin : g_out
  assign out[lane*Width+:Width] = out_words[(lane*Channels+Channel)*Width+:Width];
end
for (genvar s = 0; s < Side; s++) begin : g_captured
  assign captured_now[s] = capture_read_words[(s*Channels+Channel)*Width+:Width];
end
assign used = starts_q[Tables-1] ? named : bank;
always_ff @(posedge clk) begin
  out_q <= out;
  if (en) begin
    starts_q <= {starts_q[0], in_valid & in_frame_start};
    if (in_valid && in_frame_start) named <= table_bank;
    bank <= used;
  end
  if (started && !rst && bank != used && en) changed <= 1'b1;
  read_left <= table_read ? 2'd1 : read_left - 2'(read_left != 0);
  if (table_read) begin  // of the bank that is not in use behind this clock; other channels: unknown
    read_known <= table_channel == (ChannelLog2 + 1)'(Channel) || 32'(table_channel) >= Channels;
    read_word <= 32'(table_channel) >= Channels ? '0
        : (en ? used : bank) ? words_0[table_node] : words_1[table_node];
  end
  captured <= started && capture_read;
  for (int s = 0; s < Side; s++) begin
    captured_words[s] <= bank ? words_0[32'(capture_read_node)*Side+s] : words_1[32'(capture_read_node)*Side+s];
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
    if (held) holds: assert (out == out_q);
    if (read_known && read_left == 0) entry: assert (table_answer == expected_answer);
    if (captured) node: assert (captured_now == captured_words);
    new_frame_with_new_words: cover (changed && out_valid && out[0] && out_data);
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
always_ff @(posedge clk) if (en) places_q <= {places_q[8*(ToNext-1)-1:0], row[3:0], beat[3:0]};
logic first, next;
logic [Side-1:0][SumWidth-1:0] column_sums;
assign column_sums = dut.sums[Channel];
function automatic logic [SumWidth-1:0] extended(input logic [Width-1:0] word);
  return Signed != 0 ? SumWidth'($signed(word)) : SumWidth'(word);
endfunction
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
      logic [NumberWidth-1:0] node, below;
      node = NumberWidth'(32'(y) / Share * NodeColumns + n % Side);
      if (n >= Side && reads(beat_3)) node = node + NumberWidth'((32'(beat_3) + Ahead) / BeatsOfBlock * Side);
      below = weight == '0 ? node : NumberWidth'(32'(node) + NodeColumns);
      weighted[n*SumWidth+:SumWidth] = (SumWidth'(Share) - weight) * extended(bank ? words_1[node] : words_0[node])
          + weight * extended(bank ? words_1[below] : words_0[below]);
    end
  end
  always_ff @(posedge clk) begin
    if (en) weighted_q <= {weighted_q[2*Side*SumWidth*(ToNext-ToUse-1)-1:0], weighted};
  end
  always_comb begin
    if (started) begin
      when: assert (dut.start_q[ToFirst-2] == first && dut.segment_q[ToNext-2] == next && !(first && next));
      if (first) of_the_first: assert (column_sums == weighted_q[2*Side*SumWidth*(ToFirst-ToUse-1)+:Side*SumWidth]);
      if (next) of_the_next: assert (column_sums == weighted_q[2*Side*SumWidth*(ToNext-ToUse)-1-:Side*SumWidth]);
      weighed: cover (next && weight != '0 && column_sums[0] == SumWidth'(Signed != 0 ? 1 - Share : Share - 1) && changed);
    end
  end
end else begin : g_along
  // As the first part has it: a sum of two nodes is no larger than a whole of the largest word.
  localparam int Highest = Signed != 0 ? (1 << (Width - 1)) - 1 : (1 << Width) - 1,
      Lowest = Signed != 0 ? -(1 << (Width - 1)) : 0;
  for (genvar s = 0; s < Side; s++) begin : g_sum
    always_comb assume (whole_of(column_sums[s]) >= Share * Lowest && whole_of(column_sums[s]) <= Share * Highest);
  end
  function automatic int whole_of(input logic [SumWidth-1:0] of_nodes);
    return Signed != 0 ? 32'($signed(of_nodes)) : 32'(of_nodes);
  endfunction

  // The sums of the row so far, and the chosen pixel of the beat between them.
  localparam int ScaledWidth = SumWidth + BlockLog2 + 1, Behind = Latency - ToNext;
  logic [NodeColumns*SumWidth-1:0] sums, sums_q;
  logic [LaneWidth-1:0] chosen;
  logic [3:0] beat_7;
  logic [7:0] x;
  logic [SumWidth-1:0] left, right;
  logic [ScaledWidth-1:0] whole;
  logic [Width-1:0] word;
  logic up;
  logic [Behind*Width-1:0] word_q;
  logic [Behind*ScaledWidth-1:0] whole_q;
  assign beat_7 = places_q[8*(ToNext-1)+:4];
  always_comb begin
    sums = sums_q;
    for (int n = 0; n < NodeColumns; n++) begin
      if (next && 32'(beat_7) + Ahead == n / Side * BeatsOfBlock) begin
        sums[n*SumWidth+:SumWidth] = column_sums[n%Side];
      end
    end
    x = clamped(32'(beat_7) * Lanes + 32'(chosen), NodeColumns);
    left = SumWidth'(sums >> 32'(x) / Share * SumWidth);
    right = 32'(x) % Share == 0 ? left : SumWidth'(sums >> (32'(x) / Share + 1) * SumWidth);
    whole = ScaledWidth'(Share - 32'(x) % Share) * ScaledWidth'(whole_of(left)) + ScaledWidth'(32'(x) % Share) * ScaledWidth'(whole_of(right));
    up = whole[2*BlockLog2+1] && (whole[2*BlockLog2:0] != '0 || whole[2*BlockLog2+2]);
    word = Width'(whole >> (2 * BlockLog2 + 2)) + Width'(up);
  end
  always_ff @(posedge clk) begin
    if (!started) chosen <= 32'(choose) < Lanes ? choose : '0;
    if (en) begin
      sums_q <= sums;
      if (first) sums_q[Side*SumWidth-1:0] <= column_sums;
      word_q <= (Behind * Width)'({word_q, word});
      whole_q <= (Behind * ScaledWidth)'({whole_q, whole});
    end
  end
  always_comb begin
    if (started) begin
      if (out_valid) begin
        interpolated: assert (Width'(out >> 32'(chosen) * Width) == word_q[Behind*Width-1-:Width]);
      end
      tie: cover (out_valid && whole_q[(Behind-1)*ScaledWidth+:2*BlockLog2+2] == (1 << (2 * BlockLog2 + 1)) && held);
    end
  end
end

localparam int Last = (Side - 1) * Channels + (Channels > 1 ? 0 : Channel);
bind dut.g_node[Channel].g_table[0].u_words.g_bank[0].u_ram ram_check #(
  .Depth(Depth), .Defined(0)
) u_check_0 (.clk, .write_en, .write_address, .read_en, .read_address);
bind dut.g_node[Channel].g_table[0].u_words.g_bank[1].u_ram ram_check #(
  .Depth(Depth), .Defined(0)
) u_check_1 (.clk, .write_en, .write_address, .read_en, .read_address);
bind dut.g_node[Last].g_table[Tables-1].u_words.g_bank[0].u_ram ram_check #(
  .Depth(Depth), .Defined(0)
) u_check_2 (.clk, .write_en, .write_address, .read_en, .read_address);
bind dut.g_node[Last].g_table[Tables-1].u_words.g_bank[1].u_ram ram_check #(
  .Depth(Depth), .Defined(0)
) u_check_3 (.clk, .write_en, .write_address, .read_en, .read_address);
