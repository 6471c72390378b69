// SPDX-License-Identifier: Apache-2.0
// td_node_map: words of Lanes neighbouring pixels, interpolated between those of a coarse grid of nodes.
//
//   2b f = (2b - w) F[node] + w F[node + 1],  2 i + 1 - b = 2b node + w, clamped to the first and the last node,
//
// along rows and columns alike for blocks of b = 2^BlockLog2 pixels; exact, then one rounding half to even. td_gain_map
// does the same for one pixel per clock. Down a column: one multiplication for each node as it is read, so the tables
// are held twice, for the nodes above and below. Along a row: a ramp from pixel to pixel, for each half of a block.
// Stream in: data of beats of Lanes pixels, whole frames in raster order. Stream out: the same, with the words of the
// pixels, the first in the lowest bits. Latency: 10 cycles + log2(min(Lanes, b / 2)); a gap in, a gap out.
// Banks, bus and capture: see td_gain_map. The index of the bus is the node. The capture writes Side = max(1, Lanes /
// b) neighbouring nodes at once. <Name>_0.hex, _1.hex .. give both banks at power-up: file s has the nodes whose column
// is s modulo Side. Bit-accurate model: models/tactile_depth/common/td_node_map.py.

`default_nettype none

module td_node_map #(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Width     = 24,  // of a word
  parameter int Lanes     = 8,   // pixels in a beat
  parameter int DataWidth = 24,
  parameter     Name      = "zero",
  localparam int NodeColumns = Columns / (1 << BlockLog2),
  localparam int NodeRows = Rows / (1 << BlockLog2),
  localparam int NodeWidth = $clog2(NodeRows * NodeColumns),
  localparam int LanesLog2 = $clog2(Lanes),
  localparam int SideLog2 = LanesLog2 > BlockLog2 ? LanesLog2 - BlockLog2 : 0,
  localparam int Side = 1 << SideLog2,  // nodes side by side in a word of the memory
  localparam int WordWidth = NodeWidth - SideLog2
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    en,

  input  wire                    table_bank,
  output logic                   table_in_use,
  input  wire                    table_write,
  input  wire                    table_read,
  input  wire  [NodeWidth-1:0]   table_index,
  input  wire  [Width-1:0]       table_zero,
  output logic [Width-1:0]       table_read_zero,

  input  wire                    capture_write,
  input  wire  [WordWidth-1:0]   capture_write_node,  // of Side nodes
  input  wire  [Side*Width-1:0]  capture_zeros,

  input  wire                    in_valid,
  input  wire                    in_frame_start,      // with the first beat of a frame
  input  wire  [DataWidth-1:0]   in_data,
  output logic                   out_valid,
  output logic [DataWidth-1:0]   out_data,
  output logic [Lanes*Width-1:0] out_zeros,          // unsigned
  output logic                   active               // a beat is inside
);

  localparam int RunLog2 = LanesLog2 < BlockLog2 - 1 ? LanesLog2 : BlockLog2 - 1;
  localparam int Run = 1 << RunLog2;                   // pixels of a beat with one step between them
  localparam int Runs = Lanes / Run;                   // in a beat
  localparam int Latency = 10 + RunLog2;
  localparam int ToRun = 6;                            // stages from the place of a beat to the sums that it needs
  localparam int BeatsLog2 = LanesLog2 < BlockLog2 ? BlockLog2 - LanesLog2 : 0;  // beats of a block
  localparam int Ahead = BeatsLog2 > 0 ? 1 << (BeatsLog2 - 1) : 1;  // from a beat to one that knows the node behind it
  localparam int BeatWidth = $clog2(Columns / Lanes);
  localparam int ColumnWidth = BeatWidth - BeatsLog2;  // of a word of the memory in its row
  localparam int RowWidth = $clog2(Rows) + 1;
  localparam int NodeRowWidth = RowWidth - BlockLog2;
  localparam int ShareBits = BlockLog2 + 1;            // 2b is 2^ShareBits
  localparam int SumWidth = Width + ShareBits;
  localparam int ZeroWidth = SumWidth + ShareBits;
  localparam logic [NodeRowWidth-1:0] LastRow = NodeRowWidth'(NodeRows - 1);

  td_delay_line #(.Width(DataWidth), .Delay(Latency)) u_delay (.clk, .rst, .en, .in(in_data), .out(out_data));

  // Row and beat of the pixels. The node row below the pixels counts from half a block on: above the first centre and
  // below the last both node rows are the same, so the sum does not change.

  logic [Latency-1:0] valid_q;
  logic [1:0] frame_start_q;
  logic [BeatWidth-1:0] beat, beat_shifted;
  logic [RowWidth-1:0] row, row_shifted;
  logic [NodeRowWidth-1:0] node_row, upper_row, lower_row;
  logic [ShareBits-1:0] share, share_q, share_q2;  // of the node below
  logic row_starts, run_begins;  // run_begins: the step is another from here on
  assign row_shifted = row + (RowWidth'(1) << (BlockLog2 - 1));
  assign node_row = row_shifted[RowWidth-1:BlockLog2];
  assign beat_shifted = beat + BeatWidth'(Ahead);
  assign row_starts = valid_q[0] & beat == '0;
  assign active = |valid_q;
  assign out_valid = valid_q[Latency-1];

  // A row's first word is read with its first beat, every other one a cycle after the first beat that needs it: the one
  // at the centre of the node before it, or with a node or more to a beat the beat before its own. So two rows, or two
  // frames, never meet: the last beats of a row need no word.

  logic [ColumnWidth-1:0] next, next_q, next_q2, column;
  logic segment;
  logic [ToRun-1:0] start_q, segment_q, begins_q;
  assign next = beat_shifted[BeatWidth-1:BeatsLog2];
  assign run_begins = valid_q[0] & (row_starts | (beat_shifted & BeatWidth'($unsigned((1 << BeatsLog2) - 1))) == '0);
  assign segment = run_begins & next != '0;
  assign column = segment_q[1] ? next_q2 : '0;

  // The tables: Side of them for the nodes above, and as many for those below. Capture and bus share the free bank.

  logic [SideLog2:0] table_side, fetched_side;
  logic fetched;
  logic [WordWidth-1:0] write_word;
  logic [2*Side*Width-1:0] free_zeros;
  logic [Side*SumWidth-1:0] sums;
  logic [2*Side-1:0] in_use;
  assign table_side = (SideLog2 + 1)'(table_index) & (SideLog2 + 1)'($unsigned(Side - 1));
  assign write_word = capture_write ? capture_write_node : table_index[NodeWidth-1:SideLog2];
  assign table_in_use = &in_use;  // they change over together
  for (genvar s = 0; s < Side; s++) begin : g_node
    logic [1:0][Width-1:0] zeros;  // above, below
    for (genvar t = 0; t < 2; t++) begin : g_table
      td_banked_table #(
        .Width(Width), .Depth(NodeRows * NodeColumns / Side), .File({Name, "_", 8'(48 + s), ".hex"})
      ) u_zeros (
        .clk, .rst, .en, .table_bank, .table_in_use(in_use[2*s+t]),
        .frame_start(in_valid & in_frame_start), .change(frame_start_q[1]),
        .read(start_q[0] | segment_q[1]),
        .read_address(WordWidth'({t != 0 ? lower_row : upper_row, column})), .read_word(zeros[t]),
        .free_write(capture_write | (table_write & table_side == (SideLog2 + 1)'(s))), .free_write_address(write_word),
        .free_write_word(capture_write ? capture_zeros[s*Width+:Width] : table_zero),
        .free_read(table_read), .free_read_address(table_index[NodeWidth-1:SideLog2]),
        .free_word(free_zeros[(2*s+t)*Width+:Width])
      );
    end

    // 2b times the word above, and the share of the difference.
    logic [Width-1:0] above, above_q;
    logic signed [Width:0] fall;
    logic signed [Width+ShareBits+1:0] product;
    logic unused_signs;
    td_multiply #(.AWidth(Width + 1), .BWidth(ShareBits + 1)) u_product (
      .clk, .en, .a(fall), .b({1'b0, share_q2}), .product
    );
    assign unused_signs = ^product[SumWidth+1:SumWidth];
    always_ff @(posedge clk) begin
      if (en) begin
        {above_q, above} <= {above, zeros[0]};
        fall <= $signed({1'b0, zeros[1]}) - $signed({1'b0, zeros[0]});
        sums[s*SumWidth+:SumWidth] <= {above_q, {ShareBits{1'b0}}} + product[SumWidth-1:0];
      end
    end
  end

  // Along the row: in each run the zero offsets are a ramp between two nodes. Where a beat is a part of a block, or
  // half a block, the only run goes on from beat to beat.

  logic [Side*SumWidth-1:0] right;  // the word of sums that was done last
  logic [SumWidth-1:0] left;        // the last node of the word before it
  logic [(Side+2)*SumWidth-1:0] nodes;
  logic new_runs, new_runs_q;
  assign nodes = {
    segment_q[ToRun-1] ? sums[SumWidth-1:0] : right[Side*SumWidth-1-:SumWidth], right,
    start_q[ToRun-1] ? right[SumWidth-1:0] : left
  };
  logic unused_left;  // where the only run is behind a node
  assign unused_left = ^nodes[SumWidth-1:0];
  assign new_runs = Runs > 1 | begins_q[ToRun-1];
  for (genvar r = 0; r < Runs; r++) begin : g_run
    localparam int First = Runs > 1 ? (r + 1) / 2 : 1;
    localparam int AtCentre = Runs == 1 || r % 2 != 0 ? 1 : 0;  // the run begins at a node, not half way
    logic [SumWidth-1:0] first, last;
    logic signed [SumWidth:0] step;
    logic signed [SumWidth+1:0] apart;  // from pixel to pixel
    logic [ZeroWidth-1:0] from, zero;  // before the step; of the first pixel
    logic [Run*ZeroWidth-1:0] zeros;
    assign {last, first} = nodes[First*SumWidth+:2*SumWidth];
    always_ff @(posedge clk) begin
      if (en) begin
        if (new_runs) begin
          step <= $signed({1'b0, last}) - $signed({1'b0, first});
          from <= (ZeroWidth'(first) + ZeroWidth'(AtCentre != 0 ? first : last)) << BlockLog2;
        end
        if (valid_q[ToRun+1]) begin
          zero <= new_runs_q ? from + $unsigned(ZeroWidth'(step))
              : zero + $unsigned(ZeroWidth'(step) <<< (LanesLog2 + 1));
        end
        apart <= {step, 1'b0};
      end
    end
    td_ramp #(.Width(ZeroWidth), .StepWidth(SumWidth + 2), .Count(Run)) u_ramp (
      .clk, .en, .first(zero), .step(apart), .out(zeros)
    );
    for (genvar n = 0; n < Run; n++) begin : g_pixel
      logic signed [Width:0] rounded;
      logic unused_clipped, unused_sign;
      td_round_saturate #(.InWidth(ZeroWidth + 1), .Drop(2 * ShareBits), .OutWidth(Width + 1)) u_round (
        .in({1'b0, zeros[n*ZeroWidth+:ZeroWidth]}), .out(rounded), .clipped(unused_clipped)
      );
      assign unused_sign = rounded[Width];
      always_ff @(posedge clk) if (en) out_zeros[(r*Run+n)*Width+:Width] <= rounded[Width-1:0];
    end
  end

  // Stages.

  always_ff @(posedge clk) begin
    if (en) begin
      valid_q <= {valid_q[Latency-2:0], in_valid};
      frame_start_q <= {frame_start_q[0], in_valid & in_frame_start};
      if (in_valid) {row, beat} <= in_frame_start ? '0 : {row, beat} + (RowWidth + BeatWidth)'(1);
      upper_row <= node_row > LastRow ? LastRow : node_row == '0 ? '0 : node_row - NodeRowWidth'(1);
      lower_row <= node_row > LastRow ? LastRow : node_row;
      {share_q2, share_q, share} <= {share_q, share, row_shifted[BlockLog2-1:0], 1'b1};
      {next_q2, next_q} <= {next_q, next};
      start_q <= {start_q[ToRun-2:0], row_starts};
      segment_q <= {segment_q[ToRun-2:0], segment};
      begins_q <= {begins_q[ToRun-2:0], run_begins};
      if (segment_q[ToRun-1]) left <= right[Side*SumWidth-1-:SumWidth];
      if (segment_q[ToRun-1] || start_q[ToRun-2]) right <= sums;
      new_runs_q <= new_runs;
    end
    fetched <= table_read;
    if (table_read) fetched_side <= table_side;
    if (fetched) table_read_zero <= Width'(free_zeros >> (32'(fetched_side) * 32'($unsigned(2 * Width))));
    if (rst) begin
      valid_q <= '0;
      frame_start_q <= '0;
      start_q <= '0;
      segment_q <= '0;
      begins_q <= '0;
    end
  end

  if (BlockLog2 < 1) begin : g_refused_0
    BlockLog2_must_be_at_least_1_a_run_is_half_a_block u_refused ();
  end
  if (Columns != 1 << $clog2(Columns) || Lanes != 1 << LanesLog2) begin : g_refused_1
    Columns_and_Lanes_must_be_powers_of_two u_refused ();
  end
  if (Lanes < 2 || Columns < 2 * Lanes) begin : g_refused_2
    Lanes_must_be_at_least_2_and_at_most_half_of_Columns u_refused ();
  end
  if (NodeColumns < 2 || NodeRows < 1) begin : g_refused_3
    two_blocks_a_row_and_one_a_column_are_needed u_refused ();
  end

endmodule

`default_nettype wire
