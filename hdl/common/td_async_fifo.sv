// SPDX-License-Identifier: Apache-2.0
// td_async_fifo: queue of 2^DepthLog2 words between two clocks of any ratio.
//
// Stream in, on write_clk: a word enters in each clock with write_valid and write_ready. Stream out, on read_clk: the
// same words in the same order, each until read_ready takes it. A word is offered three clocks of the reader after it
// was written, four if it came too late for the first; 8 words are enough for one word a clock at equal clocks. Neither
// side waits for valid to raise ready. One more word waits at the output.
//
// A count crosses each way in Gray code, in which one bit changes in a clock, through two registers: a bit that is
// caught on its way makes the count before. That holds while each bit arrives within one period of the clock that it
// comes from; `make fpga` reports the routed delay. The words are registers: each was written before its count came.
//
// There is no reset, since one of the clocks may stand still in it: the registers begin with initial values. Model:
// models/tactile_depth/chip/common/td_async_fifo.py.

`default_nettype none

module td_async_fifo #(
  parameter int Width     = 10,
  parameter int DepthLog2 = 4
) (
  input  wire              write_clk,
  input  wire              write_valid,
  output logic             write_ready,
  input  wire  [Width-1:0] write_data,

  input  wire              read_clk,
  output logic             read_valid,
  input  wire              read_ready,
  output logic [Width-1:0] read_data
);

  localparam int Depth = 1 << DepthLog2;
  localparam int CodeWidth = DepthLog2 + 1;  // one bit more than an address: a full queue is not an empty one

  logic [Depth-1:0][Width-1:0] words;
  logic [CodeWidth-1:0] written_code = '0, fetched_code = '0;  // each from a register of its own clock

  // The writer: words written, and words fetched as far as it knows.

  logic [CodeWidth-1:0] written = '0;
  logic [CodeWidth-1:0] written_next, full_code;
  logic enters;
  (* async_reg = "true" *) logic [CodeWidth-1:0] fetched_code_q = '0, fetched_code_q2 = '0;
  assign written_next = written + CodeWidth'(1);
  assign full_code = fetched_code_q2 ^ {2'b11, {(CodeWidth - 2) {1'b0}}};  // Depth words further on
  assign write_ready = written_code != full_code;
  assign enters = write_valid & write_ready;

  always_ff @(posedge write_clk) begin
    fetched_code_q <= fetched_code;
    fetched_code_q2 <= fetched_code_q;
    if (enters) begin
      written <= written_next;
      written_code <= written_next ^ (written_next >> 1);
    end
  end

  for (genvar n = 0; n < Depth; n++) begin : g_word
    always_ff @(posedge write_clk) begin
      if (enters && written[DepthLog2-1:0] == DepthLog2'(n)) words[n] <= write_data;
    end
  end

  // The reader: words fetched, and words written as far as it knows.

  logic read_valid_q = 1'b0;
  logic [CodeWidth-1:0] fetched = '0;
  logic [CodeWidth-1:0] fetched_next;
  (* async_reg = "true" *) logic [CodeWidth-1:0] written_code_q = '0, written_code_q2 = '0;
  logic waiting, room;
  assign fetched_next = fetched + CodeWidth'(1);
  assign waiting = fetched_code != written_code_q2;
  assign room = read_ready | ~read_valid_q;
  assign read_valid = read_valid_q;

  always_ff @(posedge read_clk) begin
    written_code_q <= written_code;
    written_code_q2 <= written_code_q;
    if (room) read_valid_q <= waiting;
    if (room && waiting) begin
      read_data <= words[fetched[DepthLog2-1:0]];
      fetched <= fetched_next;
      fetched_code <= fetched_next ^ (fetched_next >> 1);
    end
  end

  if (DepthLog2 < 2) begin : g_refused
    DepthLog2_must_be_at_least_2 u_refused ();
  end

endmodule

`default_nettype wire
