// SPDX-License-Identifier: Apache-2.0
// reference_capture: the gains of flat_field from frames without contact.
//
//   gain = min(((2^(GainFraction + 1) n / S) + 1) >> 1, 2^Width - 1),  S the sum of n pixels: a block, in 2^k frames
//
// `request` starts a capture at any time, afresh if it is busy. From the next start of frame on it sums each block and
// channel over 2^k whole frames, k = log2_frames at that start, at most MaxLog2; in_bad with a frame's last pixel
// starts it afresh. Then one sequential divider turns each sum into its gain, channel by channel: 6 + 3 (Width + 3)
// cycles a node. All this in the bank of flat_field that is not in use; `done` is high for one cycle after the last
// gain is written, and asks for the change-over. While busy nobody else writes that bank, nor asks for a change-over.
// Stream in: pixels R in 23:16, B in 15:8, G in 7:0, the same that flat_field takes; gaps and en low change no gain.
// Latency: from the last pixel to done the cycles of all nodes and 2 more, en or not. Bit-accurate model:
// models/tactile_depth/chip/gradient/reference_capture.py.

`default_nettype none

module reference_capture
  import td_types_pkg::*;
#(
  parameter int Rows         = 128,
  parameter int Columns      = 128,
  parameter int BlockLog2    = 3,
  parameter int Width        = 24,  // of a gain, and of a sum
  parameter int GainFraction = 27,
  parameter int MaxLog2      = 8,   // of frames: 8 + 2 BlockLog2 + MaxLog2 bits fit a sum
  localparam int Nodes = nodes(Rows, Columns, BlockLog2),
  localparam int NodeWidth = $clog2(Nodes)
) (
  input  wire                  clk,
  input  wire                  rst,
  input  wire                  en,
  input  wire                  request,
  input  wire  [3:0]           log2_frames,
  output logic                 busy,
  output logic                 done,
  output captured_t            captured,         // the gains of a node, then 0, for its signature

  input  wire                  in_valid,
  input  wire  [23:0]          in_pixel,         // three codes of 8 bits
  input  wire position_t       in_position,
  input  wire                  in_bad,           // with the last pixel: the frame was malformed

  output logic                 map_write,
  output logic [NodeWidth-1:0] map_write_node,
  output logic [3*Width-1:0]   map_write_gains,  // {B, G, R}, unsigned: sums, then gains of GainFraction bits
  output logic                 map_read,
  output logic [NodeWidth-1:0] map_read_node,
  input  wire  [3*Width-1:0]   map_read_gains
);

  localparam int QuotientWidth = Width + 1;  // one bit to round by
  localparam int Scale = GainFraction + 1 + 2 * BlockLog2 - QuotientWidth;  // the numerator: 2^(Scale + k + its width)
  localparam int CountWidth = MaxLog2 > 0 ? MaxLog2 : 1;
  localparam int ReadStep = 3, TakeStep = 5;  // of Fetching; the cycles before let the last word be written

  typedef enum logic [2:0] {Idle, Armed, Summing, Fetching, Dividing} state_e;
  state_e state;
  logic [3:0] log2, log2_next;
  logic [CountWidth-1:0] frames_to_come;  // whole ones, after this one
  logic take, starts, ends, last;
  assign take = en & in_valid;
  assign starts = take & in_position.first_row & in_position.first_column & (state == Armed | state == Summing);
  assign ends = take & in_position.last_row & in_position.last_column & state == Summing;
  assign last = ends & ~in_bad & frames_to_come == '0;
  assign log2_next = log2_frames > 4'($unsigned(MaxLog2)) ? 4'(MaxLog2) : log2_frames;
  assign busy = state != Idle | done;

  logic sum_read, sum_write;
  logic [NodeWidth-1:0] sum_read_node, sum_write_node;
  logic [3*Width-1:0] sums;
  td_block_sum #(
    .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Channels(3), .Width(8), .Signed(0), .SumWidth(Width)
  ) u_sum (
    .clk, .rst, .in_valid(take & (state == Summing | starts)), .in_frame_start(starts), .in_first_frame(state == Armed),
    .in_last_frame(1'b0), .in_data({in_pixel[15:8], in_pixel[7:0], in_pixel[23:16]}),
    .read_en(sum_read), .read_block(sum_read_node), .read_sums(map_read_gains),
    .write_en(sum_write), .write_block(sum_write_node), .write_sums(sums), .write_complete()
  );

  // Gains, node by node: a word of three sums is fetched, each sum in turn gives way to its gain at the other end.

  logic [2:0] step;
  logic [1:0] channel;
  logic [NodeWidth-1:0] divide_node;
  logic [3*Width-1:0] fetched, word;  // fetched: a register right behind the memory, which is slow
  logic [Width-1:0] scale, gain;
  logic [QuotientWidth-1:0] quotient;
  logic divide_start, divided, overflow, node_ends;
  logic gains_valid = 1'b0;  // a cycle before the first reset writes no gain
  assign scale = Width'((Scale + MaxLog2 + 1)'(1) << (8'(log2) + 8'(Scale)));
  // Without an overflow the quotient stays so far below 2^QuotientWidth that rounding does not carry out.
  assign gain = overflow ? '1 : quotient[QuotientWidth-1:1] + Width'(quotient[0]);
  assign node_ends = divided & channel == 2'd2;
  td_divide #(.DivisorWidth(Width), .QuotientWidth(QuotientWidth)) u_divide (
    .clk, .rst(rst | request), .start(divide_start), .numerator({scale, QuotientWidth'(0)}), .divisor(word[Width-1:0]),
    .done(divided), .quotient, .remainder(), .overflow
  );

  logic fetches, takes, finished;
  assign fetches = state == Fetching & step == 3'(ReadStep);
  assign takes = state == Fetching & step == 3'(TakeStep);
  assign finished = gains_valid & divide_node == NodeWidth'(Nodes - 1);
  assign map_read = sum_read | fetches;
  assign map_read_node = fetches ? divide_node : sum_read_node;
  assign map_write = (sum_write | gains_valid) & ~rst;  // at power-up neither is known, nor which bank is free
  assign map_write_node = gains_valid ? divide_node : sum_write_node;
  assign map_write_gains = gains_valid ? word : sums;

  logic steps, has_word;
  logic [Width-1:0] step_word;
  assign captured = {map_write, last, steps, done, has_word ? 32'(step_word) : 32'd0};

  always_ff @(posedge clk) begin
    step <= step + 3'd1;
    steps <= (divided | gains_valid) & ~request & ~rst;
    has_word <= divided & ~request & ~rst;
    step_word <= gain;
    fetched <= map_read_gains;
    divide_start <= 1'b0;
    gains_valid <= node_ends;
    done <= finished;
    if (gains_valid) divide_node <= divide_node + NodeWidth'(1);
    case (state)
      Idle: ;
      Armed: if (starts) state <= Summing;
      Summing: if (ends) state <= in_bad ? Armed : frames_to_come == '0 ? Fetching : Summing;
      Fetching: if (finished || takes) state <= finished ? Idle : Dividing;
      Dividing: if (node_ends) state <= Fetching;
      default: ;
    endcase
    if (starts && state == Armed) begin
      log2 <= log2_next;
      frames_to_come <= (CountWidth'(1) << log2_next) - CountWidth'(1);  // with MaxLog2: all ones
    end
    if (ends) frames_to_come <= frames_to_come - CountWidth'(1);
    if (last || node_ends) step <= '0;
    if (last) divide_node <= '0;
    if (takes) begin
      word <= fetched;
      channel <= '0;
      divide_start <= 1'b1;
    end
    if (divided) begin
      word <= {gain, word[3*Width-1:Width]};
      channel <= channel + 2'd1;
      divide_start <= ~node_ends;
    end
    if (request) begin
      state <= Armed;
      divide_start <= 1'b0;
      gains_valid <= 1'b0;
      done <= 1'b0;
    end
    if (rst) begin
      state <= Idle;
      divide_start <= 1'b0;
      gains_valid <= 1'b0;
      done <= 1'b0;
    end
  end

endmodule

`default_nettype wire
