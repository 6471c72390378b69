// SPDX-License-Identifier: Apache-2.0
// zero_capture: the zero offset, from frames of depth without contact.
//
//   zero offset = round( S / 2^(2 BlockLog2 + k) ),  S the sum of the depths of a block in 2^k frames, ties to even
//
// `request` starts a capture at any time, afresh if it is busy. From the next frame on it sums each block over 2^k
// frames, k = log2_frames at that start, at most MaxLog2; during the last of them each node's zero offset goes into the
// bank of zero_offset that is not in use. `done` is high for one cycle after the last, and asks for the change-over.
// While busy nobody else writes that bank, nor asks for a change-over.
// Stream in: frames of depth before the zero offset is taken off, whole but for a reset; gaps and en low change no zero
// offset. Lanes depths of a beat, or those of a block, are added up first; with several blocks to a beat the zero
// offsets of as many neighbouring nodes leave at once. Latency: from the last beat of the last row of blocks to done 7
// cycles, and one for each level of that sum, log2(min(Lanes, 2^BlockLog2)), en or not; a request counts for beats that
// come as many cycles earlier. Bit-accurate model: models/tactile_depth/chip/depth/zero_capture.py.

`default_nettype none

module zero_capture
  import td_types_pkg::*;
#(
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int Width     = 24,
  parameter int MaxLog2   = 8,   // of frames
  parameter int Lanes     = 1,   // depths in a beat
  parameter int Parity    = 0,   // 1: a parity bit in each word of the memory
  localparam int Side = side(Lanes, BlockLog2),  // nodes written at once
  localparam int Nodes = nodes(Rows, Columns, BlockLog2) / Side,
  localparam int NodeWidth = $clog2(Nodes)
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire                     request,
  input  wire  [3:0]              log2_frames,
  output logic                    busy,
  output logic                    done,
  output captured_t               captured,         // the zero offsets that are written, for their signature

  input  wire                     in_valid,
  input  wire                     in_frame_start,   // first beat of a frame
  input  wire                     in_frame_end,     // last beat of a frame
  input  wire  [Lanes*Width-1:0]  in_data,          // depth codes, signed

  output logic                    map_write,
  output logic [NodeWidth-1:0]    map_write_node,   // of Side nodes
  output logic [Side*Width-1:0]   map_write_zero,   // depth codes, signed
  output logic                    flipped           // a word that was read has a flipped bit
);

  localparam int Drop = 2 * BlockLog2 + MaxLog2;
  localparam int SumWidth = Width + Drop;
  localparam int CountWidth = MaxLog2 > 0 ? MaxLog2 : 1;
  localparam int Levels = Lanes / Side > 1 ? $clog2(Lanes / Side) : 0;

  // Depths of a beat, added up two by two until each block has one word.
  for (genvar l = 0; l <= Levels; l++) begin : g_level
    logic valid;
    logic [1:0] marks;  // frame_start, frame_end
    logic [(Lanes>>l)*(Width+l)-1:0] words;
    if (l == 0) begin : g_depths
      assign {valid, marks, words} = {en & in_valid, in_frame_start, in_frame_end, in_data};
    end else begin : g_sums
      always_ff @(posedge clk) begin
        valid <= g_level[l-1].valid & ~rst;
        marks <= g_level[l-1].marks;
      end
      for (genvar n = 0; n < Lanes >> l; n++) begin : g_sum
        logic signed [Width+l-2:0] left, right;
        assign {right, left} = g_level[l-1].words[2*n*(Width+l-1)+:2*(Width+l-1)];
        always_ff @(posedge clk) words[n*(Width+l)+:Width+l] <= (Width + l)'(left) + (Width + l)'(right);
      end
    end
  end

  typedef enum logic [1:0] {Idle, Armed, Summing} state_e;
  state_e state;
  logic [3:0] log2, log2_next;
  logic [CountWidth-1:0] frames_to_come;  // after this one
  logic take, frame_start, frame_end, begins, ends, sums_up, last_frame;
  assign take = g_level[Levels].valid;
  assign {frame_start, frame_end} = g_level[Levels].marks;
  assign begins = take & frame_start & state == Armed;
  assign log2_next = log2_frames > 4'($unsigned(MaxLog2)) ? 4'(MaxLog2) : log2_frames;
  assign busy = state != Idle | done;
  assign sums_up = take & (state == Summing | begins);
  assign last_frame = (begins ? CountWidth'(log2_next) : frames_to_come) == '0;

  logic read_en, write_en, complete;
  logic [NodeWidth-1:0] read_node, write_node;
  logic [Side*SumWidth-1:0] sums, sums_read;
  td_block_sum #(
    .Rows(Rows), .Columns(Columns / Lanes), .BlockLog2(BlockLog2), .ColumnLog2(BlockLog2 - Levels), .Channels(Side),
    .Width(Width + Levels), .SumWidth(SumWidth)
  ) u_sum (
    .clk, .rst(rst | request), .in_valid(sums_up), .in_frame_start(frame_start), .in_first_frame(begins),
    .in_last_frame(last_frame),
    .in_data(g_level[Levels].words),
    .read_en, .read_block(read_node), .read_sums(sums_read),
    .write_en, .write_block(write_node), .write_sums(sums), .write_complete(complete)
  );
  logic last_flipped;  // the word that was read last; without a read it is unknown
  logic [2:0] read_q;
  assign flipped = last_flipped & read_q[2];
  always_ff @(posedge clk) read_q <= rst ? '0 : {read_q[1:0], read_en};
  td_parity_ram #(.Width(Side * SumWidth), .Depth(Nodes), .Style(1), .Parity(Parity)) u_sums (
    .clk, .en(1'b1), .flipped(last_flipped), .write_en, .write_address(write_node), .write_data(sums),
    .read_en, .read_address(read_node), .read_data(sums_read)
  );

  for (genvar s = 0; s < Side; s++) begin : g_mean
    logic signed [SumWidth-1:0] scaled;
    logic signed [Width:0] mean;  // which Width bits hold
    assign scaled = sums[s*SumWidth+:SumWidth] << (4'($unsigned(MaxLog2)) - log2);
    td_round_saturate #(.InWidth(SumWidth), .Drop(Drop), .OutWidth(Width + 1)) u_round (
      .in(scaled), .out(mean), .clipped()
    );
    always_ff @(posedge clk) map_write_zero[s*Width+:Width] <= complete & ~request & ~rst ? mean[Width-1:0] : '0;
  end

  logic starts;  // the last frame has begun
  logic zero_valid = 1'b0;  // a cycle before the first reset writes nothing
  assign map_write = zero_valid & ~rst;  // at power-up it is not known which bank is free
  assign ends = zero_valid & map_write_node == NodeWidth'(Nodes - 1);

  for (genvar s = 0; s < Side; s++) begin : g_signature  // from 0, of those that are written at once
    logic [31:0] zero, signature;
    assign zero = 32'($signed(map_write_zero[s*Width+:Width]));
    if (s == 0) begin : g_first
      assign signature = zero;
    end else begin : g_next
      assign signature = signature_step(g_signature[s-1].signature, zero);
    end
  end
  assign captured = {
    map_write, starts, map_write, ends & ~rst, g_signature[Side-1].signature
  };

  always_ff @(posedge clk) begin
    starts <= sums_up & frame_start & last_frame & ~request & ~rst;
    zero_valid <= complete;
    map_write_node <= write_node;
    if (begins) begin
      state <= Summing;
      log2 <= log2_next;
      frames_to_come <= (CountWidth'(1) << log2_next) - CountWidth'(1);
    end
    // After the last one all ones again: what follows before done is written nowhere.
    if (take && frame_end) frames_to_come <= frames_to_come - CountWidth'(1);
    done <= ends;
    if (ends) state <= Idle;
    if (request) state <= Armed;
    if (rst) state <= Idle;
    if (request || rst) begin
      zero_valid <= 1'b0;
      done <= 1'b0;
    end
  end

endmodule

`default_nettype wire
