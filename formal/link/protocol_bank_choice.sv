// SPDX-License-Identifier: Apache-2.0
// protocol_bank_choice: a frame ends once, behind its begin; take while a frame waits and the reader is free, done while
// one is read. A bank counts while it is written, or read.

`default_nettype none

module protocol_bank_choice (
  input  logic clk,
  input  logic rst,
  input  logic keep,
  input  logic write_begin,
  input  logic write_end,
  input  logic take,
  input  logic done,
  input  logic waiting,
  input  logic reading,
  output logic in_frame,
  output logic holds,
  output logic counts_write_bank,
  output logic counts_read_bank,
  output logic counts
);

  logic live = 1'b0, begun = 1'b0;
  assign in_frame = begun;
  assign holds = rst | ((~write_end | (begun & ~write_begin)) & (~done | reading)
      & (~take | (waiting & keep & (~reading | done))));
  assign counts = live & ~rst & holds;
  assign counts_write_bank = counts & (write_begin | begun);
  assign counts_read_bank = counts & reading;
  always_ff @(posedge clk) begin
    live <= live | rst | ~holds;
    if (write_begin || write_end) begun <= write_begin;
    if (rst || !holds) begun <= 1'b0;
  end

endmodule

`default_nettype wire
