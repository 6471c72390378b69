// SPDX-License-Identifier: Apache-2.0
// fv_zero_offset: whatever td_node_map has for them, the depths of an arbitrary beat leave less those zero offsets,
// saturated, with their own marks, Latency enabled clocks after they came; while en is low all of them hold. A clipped
// depth is counted once, nothing else is. A frame is inside from the clock behind its first beat until its last has
// left, whatever follows it. The map is told where frames begin; a zero offset that was written, by the bus or the
// capture, reads back.

parameter int Rows = 3, Columns = 4, Width = 2, Lanes = 1, Latency = 11;
localparam int BlockLog2 = 1;
input logic choose;  // the beat that is followed

localparam int Nodes = (Rows / 2) * (Columns / 2), ToZero = Latency - 1, ToOut = Latency,
    Highest = (1 << (Width - 1)) - 1, Lowest = -Highest - 1;

table_answer_t expected_answer;

// The accesses that reach the table, and the answer to them (fv_td_table_port).
logic table_write, table_read;
logic [NodeWidth-1:0] table_index;
logic [Width-1:0] table_word, asked_word;
td_table_port #(.Select(3), .IndexWidth(NodeWidth), .Width(Width), .Signed(1)) u_port (
  .clk, .rst, .table_command, .table_answer(expected_answer), .write(table_write), .read(table_read),
  .index(table_index), .word(table_word), .free_word(asked_word)
);

wire [15:0] row = u_protocol.row, column = u_protocol.column;
logic [1:0] read_left;  // clocks until what was read stands

// The beat that is followed, and the words on their way.
logic [ToOut-1:0] valid;
logic [3:0] age;  // enabled clocks since it came
logic follows, subtracts, counted, moved, held, left;
logic [$clog2(Lanes):0] clips, clips_q;  // of the beat
logic [2:0] position_followed;
logic [Lanes*Width-1:0] depths, limited, expected, zero_words;
kept #(.Width(Lanes * Width + 4)) u_kept (.clk, .rst, .en, .out({out_valid, out_position, out_data}), .held);
assign zero_words = dut.zero_words;
assign subtracts = en && follows && age == 4'(ToZero);
always_comb begin
  clips = '0;
  for (int lane = 0; lane < Lanes; lane++) begin
    int difference;
    difference = 32'($signed(depths[lane*Width+:Width])) - 32'($signed(zero_words[lane*Width+:Width]));
    clips += ($clog2(Lanes) + 1)'(difference < Lowest || difference > Highest);
    limited[lane*Width+:Width] = Width'(difference < Lowest ? Lowest : difference > Highest ? Highest : difference);
  end
end
always_ff @(posedge clk) begin
  moved <= en && !rst && valid[ToZero-1];
  counted <= subtracts;
  left <= en && !rst && out_valid && out_position[0];
  clips_q <= clips;
  if (en) begin
    valid <= {valid[ToOut-2:0], in_valid};
    age <= age + 4'd1;
    if (age == 4'(ToOut)) follows <= 1'b0;
    if (choose && !follows && in_valid) begin
      follows <= 1'b1;
      age <= 4'd1;
      position_followed <= in_position;
      depths <= in_data;
    end
  end
  if (subtracts) expected <= limited;
  if (rst) begin
    valid <= '0;
    follows <= 1'b0;
    counted <= 1'b0;
  end
end

// The banks as they should be.
logic [Width-1:0] words_0[Nodes], words_1[Nodes];
initial begin
  $readmemh("zero_0.hex", words_0);
  $readmemh("zero_0.hex", words_1);
end
logic read_known;
logic [Width-1:0] written;
logic [NodeWidth-1:0] node_written;
assign written = capture_write ? capture_zero : table_word;
assign node_written = capture_write ? capture_write_node : table_index;
always_ff @(posedge clk) begin
  if (started && (capture_write || table_write)) begin
    if (table_in_use) words_0[node_written] <= written;
    else words_1[node_written] <= written;
  end
  read_left <= table_read ? 2'd1 : read_left - 2'(read_left != 0);
  if (table_read) begin
    read_known <= u_protocol.u_protocol_node_map.settled;  // what is read while a change is due: fv_td_node_map
    asked_word <= table_in_use ? words_0[table_index] : words_1[table_index];
  end
  if (rst) begin
    read_left <= '0;
    read_known <= 1'b0;
  end
end

always_comb begin
  if (started) begin
    valid_travels: assert (out_valid == valid[ToOut-1]);
    if (follows && age == 4'(ToOut)) begin
      there: assert (out_valid);
      position_travels: assert (out_position == position_followed);
      subtracted: assert (out_data == expected);
    end
    if (counted) clipped_counted: assert (saturations == clips_q);
    if (!moved) once: assert (saturations == '0);
    frame_inside: assert (active == (row != '0 || column != '0 || valid != '0));
    if (read_known && read_left == 0) entry: assert (table_answer == expected_answer);

    clipped_below: cover (counted && saturations != '0 && out_data[Width-1] && out_position[1]);
    clipped_above: cover (counted && saturations != '0 && !out_data[Width-1] && out_position[2]);
    unclipped: cover (follows && age == 4'(ToOut) && held && &depths && 32'(out_data[Width-1:0]) == 1);
    next_inside: cover (out_valid && out_position[0] && valid[ToOut-2:0] == '1 && en);
    empties: cover (left && !active);
    negative_read: cover (read_known && read_left == 0 && table_answer.low[31] && table_in_use);
  end
end

// The map is told where frames begin, as it assumes.
logic map_start;
assign map_start = dut.u_map.in_frame_start;
always_comb if (started && in_valid && !rst) frame_begins: assert (map_start == (row == '0 && column == '0));
bind dut.u_map.g_node[0].g_table[0].u_words.g_bank[0].u_ram ram_check #(
  .Depth(Depth), .Defined(0)
) u_check_0 (.clk, .write_en, .write_address, .read_en, .read_address);
bind dut.u_map.g_node[0].g_table[0].u_words.g_bank[1].u_ram ram_check #(
  .Depth(Depth), .Defined(0)
) u_check_1 (.clk, .write_en, .write_address, .read_en, .read_address);
