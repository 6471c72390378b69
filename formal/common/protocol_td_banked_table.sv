// SPDX-License-Identifier: Apache-2.0
// protocol_td_banked_table: `change` comes one enabled clock or more behind frame_start; nothing is written in a reset or
// while a change-over is due, no word is read in the clock that writes it; words count while they stand.

`default_nettype none

module protocol_td_banked_table #(
  parameter int Depth = 256,
  localparam int AddressWidth = $clog2(Depth)
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    en,
  input  logic                    table_bank,
  input  logic                    table_in_use,
  input  logic                    frame_start,
  input  logic                    change,
  input  logic                    read,
  input  logic [AddressWidth-1:0] read_address,
  input  logic                    free_write,
  input  logic [AddressWidth-1:0] free_write_address,
  input  logic                    free_read,
  input  logic [AddressWidth-1:0] free_read_address,
  output logic                    holds,
  output logic                    counts_table_in_use,
  output logic                    counts_read_word,
  output logic                    counts_free_word
);

  localparam logic [AddressWidth:0] End = Depth;
  logic reset, live = 1'b0, begun = 1'b0, named = 1'b0, shown = 1'b0, free_shown = 1'b0;
  assign reset = rst | ~holds;
  assign holds = (rst | ~change | begun)
      & (~free_write | (~rst & table_bank == table_in_use & (~begun | named == table_in_use)))
      & (~free_write | ~free_read | free_write_address != free_read_address)
      & {1'b0, read_address} < End & {1'b0, free_write_address} < End & {1'b0, free_read_address} < End;
  assign counts_table_in_use = live;
  assign counts_read_word = live & shown;
  assign counts_free_word = live & free_shown;
  always_ff @(posedge clk) begin
    live <= live | reset;
    free_shown <= free_read & ~reset;
    if (en) begin
      begun <= frame_start | (begun & ~change);
      if (frame_start) named <= table_bank;
      shown <= read;
    end
    if (reset) begin
      begun <= 1'b0;
      shown <= 1'b0;
    end
  end

endmodule

`default_nettype wire
