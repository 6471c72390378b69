// SPDX-License-Identifier: Apache-2.0
// td_node_map: words of every pixel, interpolated between those of a coarse grid of nodes.
//
//   2b f = (2b - w) F[node] + w F[node + 1],  2 i + 1 - b = 2b node + w, clamped to the first and the last node,
//
// along rows and columns alike for blocks of b = 2^BlockLog2 pixels; exact, then one rounding half to even. Along a
// row: a ramp from pixel to pixel, for each half of a block. Stream in: data of beats of Lanes pixels, whole frames in
// raster order. Stream out: the same, with the words of the pixels, the first in the lowest bits, Channels of each.
// Latency: 10 cycles + log2(min(Lanes, b / 2)); a gap in, a gap out. Table port: docs/streams.md; a word is at index
// 2^ceil(log2(Channels)) node + channel, and one of a channel that is not there reads 0. The capture writes all words
// of Side = max(1, Lanes / b) neighbouring nodes at once and reads them 1 cycle later; what the bus reads meanwhile is
// left open. File <Name>_f.hex, f = Channels (column modulo Side) + channel, gives both banks at power-up; a memory
// without contents must be written before the first frame. Bit-accurate model:
// models/tactile_depth/chip/common/td_node_map.py.

`default_nettype none

module td_node_map
  import td_types_pkg::*;
#(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Width     = 24,  // of a word; its fraction bits are those of the nodes
  parameter int Signed    = 0,   // 1: words are signed
  parameter int Channels  = 1,   // words of a pixel
  parameter int Lanes     = 1,   // pixels in a beat
  parameter int DataWidth = 24,
  parameter int Select    = 0,   // number of the table in TABLE_SELECT
  parameter     Name      = "nodes",
  parameter int Parity    = 0,   // 1: a parity bit in each word of a memory
  parameter int Checked   = DataWidth,  // bits of the data, from the lowest, that have one while they wait
  localparam int Side = side(Lanes, BlockLog2),  // nodes side by side
  localparam int Depth = nodes(Rows, Columns, BlockLog2) / Side,
  localparam int NodeWidth = $clog2(Depth)
) (
  input  wire                             clk,
  input  wire                             rst,
  input  wire                             en,
  input  wire table_command_t             table_command,
  output table_answer_t                   table_answer,
  input  wire                             table_bank,
  output logic                            table_in_use,
  input  wire                             capture_write,
  input  wire  [NodeWidth-1:0]            capture_write_node,  // of Side nodes
  input  wire  [Side*Channels*Width-1:0]  capture_words,
  input  wire                             capture_read,
  input  wire  [NodeWidth-1:0]            capture_read_node,
  output logic [Side*Channels*Width-1:0]  capture_read_words,
  input  wire                             in_valid,
  input  wire                             in_frame_start,      // with the first beat of a frame
  input  wire  [DataWidth-1:0]            in_data,
  output logic                            out_valid,
  output logic [DataWidth-1:0]            out_data,
  output logic [Lanes*Channels*Width-1:0] out_words,
  output logic                            active,              // a beat is inside
  output logic                            flipped              // a word that was read has a flipped bit
);

  localparam int LanesLog2 = $clog2(Lanes), RunLog2 = LanesLog2 < BlockLog2 - 1 ? LanesLog2 : BlockLog2 - 1;
  localparam int Run = 1 << RunLog2;              // pixels of a beat with one step between them
  localparam int Runs = Lanes / Run;              // in a beat
  localparam int Latency = 10 + RunLog2, ToRun = 6;  // ToRun: from the position of a beat to the sums that it needs
  localparam int BeatsLog2 = LanesLog2 < BlockLog2 ? BlockLog2 - LanesLog2 : 0;  // beats of a block
  localparam int Ahead = BeatsLog2 > 0 ? 1 << (BeatsLog2 - 1) : 1;  // from a beat to one that knows the node behind it
  localparam int Tables = BeatsLog2 > 0 ? 1 : 2;  // of a word of the node
  localparam int BeatWidth = $clog2(Columns / Lanes), ColumnWidth = BeatWidth - BeatsLog2;  // in a row; of the nodes
  localparam int NodeRows = Rows >> BlockLog2, RowWidth = NodeRows > 1 ? $clog2(NodeRows) : 1;
  localparam logic [RowWidth-1:0] LastRow = RowWidth'(NodeRows - 1);
  localparam int WeightBits = BlockLog2 + 1;      // 2b is 2^WeightBits
  localparam int SumWidth = Width + WeightBits, ScaledWidth = SumWidth + WeightBits;

  // Data wait with their parity, which is taken as they come, but for the bits that come late.
  localparam int Stored = DataWidth + Parity;
  logic late_flipped;
  logic [Side*Channels-1:0][Tables-1:0] flips;
  logic [Stored-1:0] late;
  logic [Checked:0] checked;
  assign flipped = late_flipped | (flips != '0);
  assign out_data = late[DataWidth-1:0];
  td_delay_line #(.Width(Stored), .Delay(Latency)) u_delay (
    .clk, .rst, .en, .in(Stored'({^in_data[Checked-1:0], in_data})), .out(late), .flipped()
  );
  always_ff @(posedge clk) {late_flipped, checked} <= {Parity != 0 && ^checked, late[Stored-1], late[Checked-1:0]};

  // Beat of the row, and the rows of the nodes above and below the pixels with the phase between them: both are the
  // same row above the first node's centre and below the last node's.

  logic [Latency-1:0] valid_q;
  logic [1:0] frame_start_q;
  logic [BeatWidth-1:0] beat, beat_shifted;
  logic [RowWidth-1:0] above, below, above_q, below_q;
  logic [BlockLog2-1:0] row_phase;
  logic [2:0][WeightBits-1:0] weight_q;  // of the node below; the last one of the operand
  assign active = |valid_q;
  assign out_valid = valid_q[Latency-1];

  // A row's first node is read with its first beat, every other one a cycle after the first beat that needs it: the one
  // at the centre of the node before it, or with a node or more to a beat the beat before its own. So two rows, or two
  // frames, never meet: the last beats of a row need no node. The node below is read a cycle after the one above it.
  // Beats of a block or more need a word in every cycle: there two tables, above and below, are read at once.

  logic [ColumnWidth-1:0] next, column;
  logic [1:0][ColumnWidth-1:0] next_q;
  logic row_starts, run_begins, segment, reads_below, reads;  // run_begins: the step is another from here on
  logic [ToRun-1:0] start_q, segment_q, begins_q;
  logic [NodeWidth-1:0] above_at, below_at, table_node;
  logic [Tables-1:0][NodeWidth-1:0] address;
  assign row_starts = valid_q[0] & beat == '0;
  assign beat_shifted = beat + BeatWidth'(Ahead);
  assign next = beat_shifted[BeatWidth-1:BeatsLog2];
  assign run_begins = valid_q[0] & (row_starts | (beat_shifted & BeatWidth'($unsigned((1 << BeatsLog2) - 1))) == '0);
  assign segment = run_begins & next != '0;
  assign reads_below = start_q[0] | segment_q[1];
  assign column = segment_q[1] ? next_q[1] : '0;
  assign below_at = NodeWidth'({below_q, column});
  assign above_at = NodeWidth'(Tables > 1 ? {above_q, column} : {above, segment_q[0] ? next_q[0] : ColumnWidth'(0)});
  assign reads = reads_below | (Tables == 1 & (row_starts | segment_q[0]));
  assign address = (Tables * NodeWidth)'(Tables == 1 & reads_below ? {above_at, below_at} : {below_at, above_at});

  // Bus and capture share the free bank.
  localparam int EntryLog2 = $clog2(Side * Channels);  // entries in a word of the memory
  logic table_write, table_read;
  logic [NodeWidth+EntryLog2-1:0] table_index;
  logic [Width-1:0] table_word;
  logic [Side*Channels-1:0][Tables-1:0] in_use;
  wire [EntryLog2:0] entry = (EntryLog2 + 1)'(table_index) & (EntryLog2 + 1)'($unsigned((1 << EntryLog2) - 1));
  assign table_node = NodeWidth'(table_index >> EntryLog2);
  assign table_in_use = &in_use;  // they change over together
  td_table_port #(
    .Select(Select), .IndexWidth(NodeWidth + EntryLog2), .Width(Width), .Entries(Side * Channels), .Signed(Signed)
  ) u_port (
    .clk, .rst, .table_command, .table_answer, .write(table_write), .read(table_read), .index(table_index),
    .word(table_word), .free_word(capture_read_words)
  );

  // Down the column. One table gives a word after the other: their products with 2b - w and w are added. Two give both
  // at once: w times their difference is added to 2b times the one above.

  logic [2:0] second_q;  // a word of the node below, or two words, behind the memory, the register, the multiplier
  logic [Channels-1:0][Side-1:0][SumWidth-1:0] sums;
  for (genvar n = 0; n < Side * Channels; n++) begin : g_node
    logic [Tables-1:0][Width-1:0] read_words, free_words;
    for (genvar t = 0; t < Tables; t++) begin : g_table
      td_banked_table #(
        .Width(Width), .Depth(Depth), .File({Name, "_", "0" + 8'(n), ".hex"}), .Parity(Parity)
      ) u_words (
        .clk, .rst, .en, .table_bank, .table_in_use(in_use[n][t]), .frame_start(in_valid & in_frame_start),
        .change(frame_start_q[Tables-1]), .read(reads), .read_address(address[t]), .read_word(read_words[t]),
        .free_write(capture_write | (table_write & entry == (EntryLog2 + 1)'(n))),
        .free_write_address(capture_write ? capture_write_node : table_node),
        .free_write_word(capture_write ? capture_words[n*Width+:Width] : table_word),
        .free_read(capture_read | table_read), .free_read_address(capture_read ? capture_read_node : table_node),
        .free_word(free_words[t]), .flipped(flips[n][t])
      );
    end
    assign capture_read_words[n*Width+:Width] = free_words[0];
    logic [1:0][Width-1:0] above_word_q;
    logic signed [Width:0] last, operand;
    logic [SumWidth-1:0] base;  // what the product is added to
    logic signed [Width+WeightBits+1:0] product;
    assign last = {Signed != 0 & read_words[Tables-1][Width-1], read_words[Tables-1]};
    assign base = Tables > 1 ? {above_word_q[1], {WeightBits{1'b0}}} : second_q[2] ? sums[n%Channels][n/Channels] : '0;
    td_multiply #(.AWidth(Width + 1), .BWidth(WeightBits + 1)) u_product (
      .clk, .en, .a(operand), .b({1'b0, weight_q[2]}), .product
    );
    always_ff @(posedge clk) begin
      if (en) begin
        above_word_q <= {above_word_q[0], read_words[0]};
        operand <= last - (Tables > 1 ? $signed({Signed != 0 & read_words[0][Width-1], read_words[0]}) : '0);
        sums[n%Channels][n/Channels] <= base + product[SumWidth-1:0];  // base last: Yosys 0.70 inverts its choice
      end
    end
  end

  // Along the row: in each run the words are a ramp between two nodes. Where a beat is a part of a block, or half a
  // block, the only run goes on from beat to beat.

  logic new_runs, new_runs_q;
  assign new_runs = Runs > 1 | begins_q[ToRun-1];
  for (genvar c = 0; c < Channels; c++) begin : g_channel
    logic [Side-1:0][SumWidth-1:0] right;  // the sums that were done last
    logic [SumWidth-1:0] left;             // the last node of those before them
    logic [Side+1:0][SumWidth-1:0] ends;   // of the runs
    assign ends = {segment_q[ToRun-1] ? sums[c][0] : right[Side-1], right, start_q[ToRun-1] ? right[0] : left};
    always_ff @(posedge clk) begin
      if (en && segment_q[ToRun-1]) left <= right[Side-1];
      if (en && (segment_q[ToRun-1] || start_q[ToRun-2])) right <= sums[c];
    end
    for (genvar r = 0; r < Runs; r++) begin : g_run
      localparam int First = Runs > 1 ? (r + 1) / 2 : 1;
      logic signed [SumWidth:0] first, last, step;
      logic signed [SumWidth+1:0] apart;      // from pixel to pixel
      logic [ScaledWidth-1:0] from, scaled;   // before the step, at a node or half way; of the first pixel
      logic [Run-1:0][ScaledWidth-1:0] ramp;
      assign first = {Signed != 0 & ends[First][SumWidth-1], ends[First]};
      assign last = {Signed != 0 & ends[First+1][SumWidth-1], ends[First+1]};
      always_ff @(posedge clk) begin
        if (en) begin
          if (new_runs) begin
            step <= last - first;
            from <= (ScaledWidth'(first) + ScaledWidth'(Runs == 1 || r % 2 != 0 ? first : last)) << BlockLog2;
          end
          if (valid_q[ToRun+1]) begin
            scaled <= (new_runs_q ? from : scaled)
                + $unsigned(new_runs_q ? ScaledWidth'(step) : ScaledWidth'(step) <<< (LanesLog2 + 1));
          end
          apart <= {step, 1'b0};
        end
      end
      td_ramp #(.Width(ScaledWidth), .StepWidth(SumWidth + 2), .Count(Run)) u_ramp (
        .clk, .en, .first(scaled), .step(apart), .out(ramp)
      );
      for (genvar n = 0; n < Run; n++) begin : g_pixel
        logic signed [Width:0] rounded;
        td_round_saturate #(.InWidth(ScaledWidth + 1), .Drop(2 * WeightBits), .OutWidth(Width + 1)) u_round (
          .in({Signed != 0 & ramp[n][ScaledWidth-1], ramp[n]}), .out(rounded), .clipped()
        );
        always_ff @(posedge clk) if (en) out_words[((r*Run+n)*Channels+c)*Width+:Width] <= rounded[Width-1:0];
      end
    end
  end

  always_ff @(posedge clk) begin
    if (en && in_valid) begin
      beat <= in_frame_start ? '0 : beat + BeatWidth'(1);
      if (in_frame_start) begin
        {above, below} <= '0;
        row_phase <= BlockLog2'(1 << (BlockLog2 - 1));
      end else if (beat == '1) begin
        row_phase <= row_phase + BlockLog2'(1);
        if (row_phase == '1) {above, below} <= {below, below == LastRow ? LastRow : below + RowWidth'(1)};
      end
    end
    if (en) begin
      valid_q <= {valid_q[Latency-2:0], in_valid};
      frame_start_q <= {frame_start_q[0], in_valid & in_frame_start};
      {above_q, below_q} <= {above, below};
      weight_q <= {Tables == 1 & ~second_q[0] ? -weight_q[0] : weight_q[1], weight_q[0], row_phase, 1'b1};
      second_q <= {second_q[1:0], reads_below};
      next_q <= {next_q[0], next};
      start_q <= {start_q[ToRun-2:0], row_starts};
      segment_q <= {segment_q[ToRun-2:0], segment};
      begins_q <= {begins_q[ToRun-2:0], run_begins};
      new_runs_q <= new_runs;
    end
    if (rst) {valid_q, frame_start_q, start_q, segment_q, begins_q} <= '0;
  end

  // Refused.

  if (Columns != 1 << $clog2(Columns) || Lanes != 1 << LanesLog2 || (Side > 1 && Channels != 1 << $clog2(Channels)))
  begin : g_refused_0
    Columns_and_Lanes_must_be_powers_of_two_with_Lanes_of_two_blocks_Channels_too u_refused ();
  end
  if (BlockLog2 < 1 || Columns < 2 * Lanes || Columns >> BlockLog2 < 2 || NodeRows < 1) begin : g_refused_1
    blocks_of_2_pixels_or_more_two_beats_and_two_blocks_a_row_and_one_block_a_column_are_needed u_refused ();
  end

endmodule

`default_nettype wire
