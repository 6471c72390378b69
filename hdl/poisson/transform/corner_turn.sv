// SPDX-License-Identifier: Apache-2.0
// corner_turn: rows that come side by side, one word of each a cycle, leave in turn, several words of one a cycle.
//
// Stream in: bursts of Columns words in Makhoul order (0, 2, 4, .., 5, 3, 1); the lanes have the rows of a frame in
// turn, each Columns / Lanes cycles behind the row before, without a pause. Stream out: the same rows in the same
// order, each a burst of Columns / Lanes cycles with Lanes words in natural order, the first word in the lowest bits.
// Latency: 3 cycles from the last word of a row to its first words out.
//
// In every cycle each lane writes a word, and Lanes words of one row are read, so there are Lanes memories. The words
// that leave together are neighbours in the first half of the burst (even words) and in the second half (odd words).
// Two lanes that are Lanes / 2 apart are half a burst apart. So half of the memories hold first halves; there, position
// p of lane e is in memory p + e (Columns / Lanes + 1), modulo Lanes / 2. The others hold second halves in the same
// way. The address is the time of the write, modulo two bursts. Bit-accurate model:
// models/tactile_depth/poisson/transform/corner_turn.py.

`default_nettype none

module corner_turn #(
  parameter int Width   = 24,
  parameter int Columns = 128,
  parameter int Lanes   = 8
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    en,
  input  wire  [Lanes-1:0]       in_start,
  input  wire                    in_frame_start,   // with in_start[0]: the first row of a frame
  input  wire  [Lanes*Width-1:0] in_data,          // a word for each lane, of any format, unchanged in out_data
  output logic                   out_start,
  output logic                   out_frame_start,  // the first row of a frame
  output logic [Lanes*Width-1:0] out_data
);

  localparam int Step = Columns / Lanes;  // cycles from a row to the next
  localparam int Half = Lanes / 2;
  localparam int IndexWidth = Half > 1 ? $clog2(Half) : 1;
  localparam int LaneWidth = $clog2(Lanes);
  localparam int StepWidth = $clog2(Step);
  localparam int AddressWidth = StepWidth + LaneWidth + 1;
  localparam logic [AddressWidth-1:0] Stride = AddressWidth'(Half);  // positions that a cycle reads in half a burst
  localparam logic [AddressWidth-1:0] Last = AddressWidth'(Columns - 1);
  localparam logic [IndexWidth-1:0] LaneOffset = IndexWidth'(Step + 1);

  // Word m of the result is word m + amount, modulo Half.
  function automatic logic [Half*Width-1:0] rotated(
    input logic [Half*Width-1:0] words, input logic [IndexWidth-1:0] amount
  );
    rotated = words;
    for (int level = 0; (1 << level) < Half; level++) begin
      if (amount[level]) rotated = (rotated >> (Width << level)) | (rotated << (Half * Width - (Width << level)));
    end
  endfunction

  // Time since the frame began, modulo two bursts: position p of a burst of lane e comes at e Step + p.
  logic [AddressWidth-1:0] now, now_q;
  logic [LaneWidth-1:0] turn;  // the lane that begins a burst in this step
  logic [StepWidth-1:0] step;
  logic step_end;
  assign now = in_frame_start ? '0 : now_q;
  assign {turn, step} = now[AddressWidth-2:0];
  assign step_end = step == StepWidth'(Step - 1);

  // Writer.
  logic [Lanes-1:0] active, running, ends;
  logic [Half*Width-1:0] in_first, in_second, write_first, write_second;
  logic row_end;
  assign active = in_start | running;
  assign row_end = |(active & ends);
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    assign ends[lane] = step_end && turn == LaneWidth'((lane + Lanes - 1) % Lanes);
  end
  for (genvar pair = 0; pair < Half; pair++) begin : g_pair
    logic [LaneWidth-1:0] steps;  // since lane `pair` began its burst; it is in the second half from Half on
    logic [Width-1:0] word, other;
    assign steps = turn - LaneWidth'(pair);
    assign word = in_data[pair*Width+:Width];
    assign other = in_data[(pair+Half)*Width+:Width];
    assign in_first[pair*Width+:Width] = steps[LaneWidth-1] ? other : word;
    assign in_second[pair*Width+:Width] = steps[LaneWidth-1] ? word : other;
  end
  assign write_first = rotated(in_first, -now[IndexWidth-1:0]);
  assign write_second = rotated(in_second, -now[IndexWidth-1:0]);

  // Reader, in the step behind the end of a row: its lane begins the next one now, and this one began a burst ago.
  logic read_active, frame_start, frame_start_q, read_frame_start, start_q, start_frame_q;
  logic [AddressWidth-1:0] begun, ahead;
  logic [IndexWidth-1:0] offset, offset_q;  // of position 0
  logic [Half*Width-1:0] read_first, read_second, mirrored, out_first, out_second;
  assign begun = {~now[AddressWidth-1], turn, StepWidth'(0)};
  assign ahead = AddressWidth'(step) * Stride;
  assign offset = IndexWidth'(turn) * LaneOffset;
  for (genvar index = 0; index < Half; index++) begin : g_memories
    logic [IndexWidth-1:0] even, odd;  // of the words that leave together, the one in this memory
    assign even = Half > 1 ? IndexWidth'(index) - offset : '0;
    assign odd = Half > 1 ? offset - IndexWidth'(index + 1) : '0;
    td_ram #(.Width(Width), .Depth(2 * Columns)) u_first (
      .clk,
      .write_en     (en & (|active)),
      .write_address(now),
      .write_data   (write_first[index*Width+:Width]),
      .read_en      (en & read_active),
      .read_address (begun + ahead + AddressWidth'(even)),
      .read_data    (read_first[index*Width+:Width])
    );
    td_ram #(.Width(Width), .Depth(2 * Columns)) u_second (
      .clk,
      .write_en     (en & (|active)),
      .write_address(now),
      .write_data   (write_second[index*Width+:Width]),
      .read_en      (en & read_active),
      .read_address (begun + Last - ahead - AddressWidth'(odd)),
      .read_data    (read_second[index*Width+:Width])
    );
    assign mirrored[index*Width+:Width] = read_second[(Half-1-index)*Width+:Width];
  end
  assign out_first = rotated(read_first, offset_q);
  assign out_second = rotated(mirrored, -offset_q);

  assign frame_start = in_frame_start | frame_start_q;
  always_ff @(posedge clk) begin
    if (en) begin
      now_q <= now + AddressWidth'(1);
      running <= active & ~ends;
      frame_start_q <= frame_start & ~row_end;
      if (step_end) begin
        read_active <= row_end;
        read_frame_start <= row_end & frame_start;
      end
      start_q <= read_active & (step == '0);
      start_frame_q <= read_active & (step == '0) & read_frame_start;
      offset_q <= offset;
      out_start <= start_q;
      out_frame_start <= start_frame_q;
      for (int index = 0; index < Half; index++) begin
        out_data[2*index*Width+:Width] <= out_first[index*Width+:Width];
        out_data[(2*index+1)*Width+:Width] <= out_second[index*Width+:Width];
      end
    end
    if (rst) begin
      running <= '0;
      read_active <= 1'b0;
      start_q <= 1'b0;
      start_frame_q <= 1'b0;
      out_start <= 1'b0;
      out_frame_start <= 1'b0;
    end
  end

  if (Lanes < 2 || Lanes != (1 << $clog2(Lanes)) || Columns < 2 * Lanes || Columns != (1 << $clog2(Columns)))
  begin : g_refused
    Lanes_and_Columns_must_be_powers_of_two_of_at_least_2_and_2_Lanes u_refused ();
  end

endmodule

`default_nettype wire
