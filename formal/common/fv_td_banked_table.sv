// SPDX-License-Identifier: Apache-2.0
// fv_td_banked_table: a frame reads the bank that was named when it began, from its change on; the free bank reads as it
// was last written; table_in_use says which is which.
//
// An arbitrary address is watched.

parameter int Width = 1, Depth = 3, Parity = 0;
input logic [AddressWidth-1:0] chosen;

always_comb assume (32'(chosen) < Depth);

logic [AddressWidth-1:0] watched;  // chosen in the first clock, then constant
logic [1:0] known = '0, word;      // of each bank: what the watched address holds
logic bank, named, used, changed;
assign used = en && change ? named : bank;
logic shown, free_shown, stays;  // the watched word stands on the port; and has through a clock without en
logic expected, free_expected;
always_ff @(posedge clk) begin
  if (!started) watched <= chosen;
  else if (free_write && free_write_address == watched) begin
    known[~bank] <= 1'b1;
    word[~bank] <= free_write_word[0];
  end
  bank <= rst ? table_bank : used;
  if (rst || (en && frame_start)) named <= table_bank;
  changed <= ~rst & (changed | (en & change & named != bank));
  stays <= shown & ~en;
  if (en) begin
    shown <= read && read_address == watched && known[used];
    expected <= word[used];
  end
  free_shown <= !rst && free_read && free_read_address == watched && known[~used];
  free_expected <= word[~used];
  if (rst) shown <= 1'b0;
end

always_comb begin
  if (started) begin
    which: assert (table_in_use == bank);
    if (shown) of_frame: assert (read_word[0] == expected);
    if (free_shown) of_free: assert (free_word[0] == free_expected);
    after_change: cover (shown && stays && changed && known == 2'b11 && word == 2'b01 && expected);
    read_in_change: cover (en && change && named != bank && free_read && shown);
    free_read_shown: cover (free_shown && free_expected && shown && !expected);
  end
end

bind dut.g_bank[0].u_ram ram_check #(.Depth(Depth), .Defined(0)) u_check_0 (.*);
bind dut.g_bank[1].u_ram ram_check #(.Depth(Depth), .Defined(0)) u_check_1 (.*);

// Protocol: `change` comes one enabled clock or more behind frame_start; nothing is written in a reset or while a
// change-over is due, no word is read in the clock that writes it, with Parity the one behind; words count while they
// stand.
module protocol_td_banked_table;
  localparam logic [AddressWidth:0] End = Depth;
  logic begun = 1'b0, named = 1'b0, shown = 1'b0, free_shown = 1'b0, writes_late = 1'b0;
  logic [AddressWidth-1:0] late_address;
  assign holds = (rst | ~change | begun)
      & (~free_write | (~rst & table_bank == table_in_use & (~begun | named == table_in_use)))
      & (~free_write | ~free_read | free_write_address != free_read_address)
      & (~writes_late | ~free_read | late_address != free_read_address)
      & {1'b0, read_address} < End & {1'b0, free_write_address} < End & {1'b0, free_read_address} < End;
  assign counts_table_in_use = live;
  assign counts_read_word = live & shown;
  assign counts_free_word = live & free_shown;
  always_ff @(posedge clk) begin
    free_shown <= free_read & ~reset;
    writes_late <= free_write & Parity != 0;
    late_address <= free_write_address;
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
