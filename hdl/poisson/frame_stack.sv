// SPDX-License-Identifier: Apache-2.0
// frame_stack: rows of a frame in, a few words a clock; last row first out, two rows side by side.
//
// Stream in: bursts of Columns / InWords clocks, Rows of them a frame, any gaps between bursts. With each row come its
// own words, which count in the last row, and those of the row above. Stream out: pairs of rows, the last row first,
// bursts of Beats = Columns / Paths clocks, Paths words of the lower row and as many of the upper one a clock; a pair
// begins 2 Columns / Lanes clocks after the one before. Starts of both come 6 clocks before the first words.
// Latency: 1 clock from the first words of the last row in to its first words out, or Columns / InWords - Beats + 4 if
// words come more slowly than they leave; nothing need follow. Rows come at least as slowly as they leave.
//
// With an odd number of rows the last pair is a row alone; what leaves beside it has no meaning.
//
// In place: the reader is always ahead of the writer of the next frame, which goes the way that the reader goes, up and
// down in turn. Lower rows of pairs have a memory, and upper ones. The last row and the one above it need none, or one
// of a row each if words come more slowly than they leave. A row of a memory has the words of a clock, or WordsPerRow
// words if those of a clock are one: the first row of a burst has fewer, so that a burst ends with a full one.
// Bit-accurate model: models/tactile_depth/chip/poisson/frame_stack.py.

`default_nettype none

module frame_stack #(
  parameter int Width       = 24,
  parameter int Rows        = 128,  // at least 4
  parameter int Columns     = 128,
  parameter int InWords     = 1,  // a power of two up to Paths and Columns / 8
  parameter int Lanes       = 1,  // a power of two up to Columns / 2
  parameter int WordsPerRow = 1,
  parameter int Style       = 1,  // of the memory, hdl/common/td_ram.sv
  parameter int Parity      = 0,  // 1: a parity bit in each row of a memory
  localparam int Paths = Lanes > 1 ? Lanes / 2 : 1
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire                       in_start,         // 6 clocks before the first words
  input  wire                       in_frame_start,   // with in_start: the first burst of a frame
  input  wire  [InWords*Width-1:0]  in_last,          // words of any format; those of the last row count
  input  wire  [InWords*Width-1:0]  in_ahead,         // of the row above
  output logic                      out_start,        // 6 clocks before the first words of a pair
  output logic                      out_frame_start,
  output logic                      out_alone,        // with out_start: the pair is one row
  output logic [2*Paths*Width-1:0]  out_data,         // the lower row in the lower bits
  output logic                      flipped           // a word that was read has a flipped bit
);

  localparam int Clocks = Columns / InWords;
  localparam int Beats = Columns / Paths;
  localparam int Period = 2 * Columns / Lanes;
  localparam int RowWords = Paths > 1 ? Paths : WordsPerRow;  // of a memory
  localparam int Gather = RowWords / InWords;  // clocks in which they come
  localparam int Serve = RowWords / Paths;  // and leave
  localparam int Burst = (Columns + RowWords - 1) / RowWords;  // memory rows of a burst
  localparam int Pairs = (Rows + 1) / 2;
  localparam int ClockWidth = $clog2(Clocks);
  localparam int BeatWidth = $clog2(Beats);
  localparam int PeriodWidth = $clog2(Period);
  localparam int GatherWidth = Gather > 1 ? $clog2(Gather) : 1;
  localparam int ServeWidth = Serve > 1 ? $clog2(Serve) : 1;
  localparam int RowWidth = $clog2(Rows + 1);
  localparam int PairWidth = $clog2(Pairs);
  localparam int Lead = 6;
  localparam int ToRead = Lead - 3;  // clocks from out_start to the read of the first words
  localparam bit Past = InWords == Paths;  // the last two rows go past the memories
  localparam int BeginsAt = Past ? 0 : Clocks - Beats + 3;
  // Clocks of a memory row that are still to come: of a burst's first one.
  localparam logic [GatherWidth-1:0] FirstGather = GatherWidth'((Clocks - 1) % Gather);
  localparam logic [ServeWidth-1:0] FirstServe = ServeWidth'((Beats - 1) % Serve);

  // Rows of the frame that have begun.
  logic [RowWidth-1:0] begun, begun_q;
  logic [ClockWidth-1:0] position;
  logic active, begins, ends;  // begins: the reader; ends: the last row has begun
  logic down;  // the way of the writer through the memories, up from row 0 or down; behind begins that of the reader
  td_burst_counter #(.Words(Clocks)) u_clocks (
    .clk, .rst, .en, .start(in_start), .position, .active
  );
  assign begun = !in_start ? begun_q : in_frame_start ? RowWidth'(1) : begun_q + RowWidth'(1);
  assign ends = in_start ? !in_frame_start && begun_q == RowWidth'(Rows - 1) : begun_q == RowWidth'(Rows);
  assign begins = active & (position == ClockWidth'(BeginsAt)) & ends;

  // Writer. It counts a clock ahead of the words (coming), so that the enables of the memories are registers.
  logic [Lead-2:0] start_q;
  logic [ClockWidth-1:0] coming_position;
  logic coming, coming_start, coming_row, ends_burst;
  logic [1:0] stores;  // in the memory of each side
  logic [RowWidth-1:0] coming_written, written;  // begun, of the words present
  logic [GatherWidth-1:0] gather, gather_q;
  logic [RowWords*Width-1:0] ahead;
  assign coming_start = start_q[Lead-2];
  td_burst_counter #(.Words(Clocks)) u_write (
    .clk, .rst, .en, .start(coming_start), .position(coming_position), .active(coming)
  );
  assign gather = Gather == 1 ? '0 : coming_start ? FirstGather : gather_q;
  assign coming_row = coming & (gather == '0);
  assign coming_written = coming_start ? begun_q : written;
  always_ff @(posedge clk) begin
    if (en) begin
      begun_q <= begun;
      start_q <= {start_q[Lead-3:0], in_start};
      gather_q <= gather == '0 ? GatherWidth'(Gather - 1) : gather - GatherWidth'(1);
      down <= down ^ begins;
      written <= coming_written;
      ends_burst <= coming_position == ClockWidth'(Clocks - 1);
      for (int side = 0; side < 2; side++) begin
        stores[side] <= coming_row & (coming_written != RowWidth'(1)) & (coming_written != RowWidth'(Rows))
            & (coming_written[0] == 1'(Rows - 1 - side));
      end
    end
    if (rst) begin
      begun_q <= RowWidth'(Rows);
      {start_q, down, stores} <= '0;
    end
  end
  if (Gather > 1) begin : g_gather
    localparam int Kept = RowWords - InWords;
    logic [Kept*Width-1:0] kept;
    assign ahead = {in_ahead, kept};
    always_ff @(posedge clk) if (en) kept <= ahead[RowWords*Width-1:InWords*Width];
  end else begin : g_at_once
    assign ahead = in_ahead;
  end

  // Reader: starts of the pairs, and behind them the reads, a clock ahead too.
  logic [PairWidth-1:0] pair;  // that are still to begin
  logic starts_active, pair_end, next_start, next_read, next_first_pair, next_row;
  logic [PeriodWidth-1:0] start_time;
  logic [BeatWidth-1:0] next_time;
  logic [ToRead-2:0] read_start_q, frame_start_q, alone_q;
  logic [ServeWidth-1:0] next_serve, next_serve_q, serve;
  logic [1:0] reads;  // the memory of each side
  logic first_pair, ends_read;
  td_burst_counter #(.Words(Period)) u_starts (
    .clk, .rst, .en, .start(out_start), .position(start_time), .active(starts_active)
  );
  assign out_alone = Rows % 2 != 0 && pair == '0;
  assign pair_end = starts_active & (start_time == PeriodWidth'(Period - 1));
  assign next_start = read_start_q[ToRead-2];
  td_burst_counter #(.Words(Beats)) u_read (
    .clk, .rst, .en, .start(next_start), .position(next_time), .active(next_read)
  );
  assign next_first_pair = next_start ? frame_start_q[ToRead-2] : first_pair;
  assign next_serve = Serve == 1 ? '0 : next_start ? FirstServe : next_serve_q;
  assign next_row = next_read & ~next_first_pair & (next_start | (next_serve == ServeWidth'(Serve - 1)));

  always_ff @(posedge clk) begin
    if (en) begin
      out_start <= begins | (pair_end & (pair != '0));
      out_frame_start <= begins;
      if (begins) pair <= PairWidth'(Pairs - 1);
      else if (pair_end && pair != '0) pair <= pair - PairWidth'(1);
      read_start_q <= {read_start_q[ToRead-3:0], out_start};
      frame_start_q <= {frame_start_q[ToRead-3:0], out_frame_start};
      alone_q <= {alone_q[ToRead-3:0], out_alone};
      first_pair <= next_first_pair;
      next_serve_q <= next_serve == '0 ? ServeWidth'(Serve - 1) : next_serve - ServeWidth'(1);
      serve <= next_serve;
      reads <= {next_row & ~alone_q[ToRead-2], next_row};
      ends_read <= next_time == BeatWidth'(Beats - Serve);  // with the last memory row of a burst
    end
    if (rst) {pair, out_start, out_frame_start, read_start_q, frame_start_q, reads} <= '0;
  end

  logic [1:0] past_q, row_flipped, past_flipped;
  logic [1:0][ServeWidth-1:0] serve_q;  // the upper one of the words behind the register
  assign flipped = {row_flipped, past_flipped} != '0;
  always_ff @(posedge clk) begin
    if (en) begin
      past_q <= {past_q[0], first_pair};
      serve_q <= {serve_q[0], serve};
    end
  end

  for (genvar side = 0; side < 2; side++) begin : g_side  // lower row of a pair, upper row
    localparam int Slots = (Rows - 1 - side) / 2;
    localparam int Depth = Slots * Burst;
    localparam int AddressWidth = $clog2(Depth);
    localparam logic [AddressWidth-1:0] Top = AddressWidth'(Depth - Burst);

    function automatic logic [AddressWidth-1:0] address_after(
      input logic [AddressWidth-1:0] address, input logic last_of_burst
    );
      address_after = address + (last_of_burst & down ? AddressWidth'(1 - 2 * Burst) : AddressWidth'(1));
    endfunction

    // The words of the row above, which comes with the row after it.
    logic [AddressWidth-1:0] write_address, read_address;
    logic [RowWords*Width-1:0] words;
    td_parity_ram #(.Width(RowWords * Width), .Depth(Depth), .Style(Style), .Latency(2), .Parity(Parity)) u_ram (
      .clk, .en, .write_en(en & stores[side]), .write_address, .write_data(ahead), .read_en(en & reads[side]),
      .read_address, .read_data(words), .flipped(row_flipped[side])
    );
    always_ff @(posedge clk) begin
      if (en) begin
        if (written == RowWidth'(1)) write_address <= down ? Top : '0;
        else if (stores[side]) write_address <= address_after(write_address, ends_burst);
        // A frame that was written upwards is read from the top down; its last burst needs no address behind it.
        if (first_pair) read_address <= down ? Top : '0;
        else if (reads[side]) read_address <= address_after(read_address, ends_read);
      end
    end

    logic [InWords*Width-1:0] in_words;
    logic [Paths*Width-1:0] past, lowest, word;
    assign in_words = side == 0 ? in_last : in_ahead;
    if (Past) begin : g_past
      assign past = in_words;
      assign past_flipped[side] = 1'b0;
    end else begin : g_buffer
      logic [RowWords*Width-1:0] row_words;
      logic [BeatWidth-1:0] write_time, read_time;
      logic write_row, reads_row;
      always_ff @(posedge clk) begin
        if (en) begin
          {write_row, write_time} <= {coming_row, coming_position[ClockWidth-1-:BeatWidth]};
          {reads_row, read_time} <= {next_read & next_first_pair, next_time};
        end
        if (rst) {write_row, reads_row} <= '0;
      end
      if (side == 0) begin : g_last
        logic [(RowWords-InWords)*Width-1:0] kept;
        assign row_words = {in_last, kept};
        always_ff @(posedge clk) if (en) kept <= row_words[RowWords*Width-1:InWords*Width];
      end else begin : g_above
        assign row_words = ahead;
      end
      td_parity_ram #(.Width(RowWords * Width), .Depth(Beats), .Style(0), .Latency(2), .Parity(Parity)) u_row (
        .clk, .en,
        .write_en     (en & write_row),
        .write_address(write_time),
        .write_data   (row_words),
        .read_en      (en & reads_row),
        .read_address (read_time),
        .read_data    (past),
        .flipped      (past_flipped[side])
      );
    end
    assign lowest = words[Paths*Width-1:0];
    wire [ServeWidth-1:0] word_serve = serve_q[1];
    always_comb begin
      word = lowest;
      for (int later = 1; later < Serve; later++) begin
        if (word_serve == ServeWidth'(Serve - 1 - later)) word = words[later*Width+:Paths*Width];
      end
    end
    always_ff @(posedge clk) if (en) out_data[side*Paths*Width+:Paths*Width] <= past_q[1] ? past : word;
  end

endmodule

`default_nettype wire
