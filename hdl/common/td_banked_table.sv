// SPDX-License-Identifier: Apache-2.0
// td_banked_table: a table held twice: frames read one bank; the other, the free bank, is written and read by others.
//
// The bank of a frame is the one that table_bank names with frame_start. It is in use from `change` on, which comes
// with the first read of the frame, one enabled cycle or more after frame_start; both count with en. In reset
// table_bank counts at once. table_in_use says which bank is in use. Nothing is written while a change-over is due:
// while table_bank, or the bank named last, is not table_in_use. No word is read in the cycle that writes it.
// Latency: read_word is valid from 1 cycle after a read with en to the end of the next cycle with en. free_word is
// valid 1 cycle after a free_read outside a reset, in that cycle alone; after a read in the cycle of a change it is of
// the bank that was left. File gives both banks at power-up. Bit-accurate model:
// models/tactile_depth/chip/common/td_banked_table.py.
//
// Parity 1: each word is stored, and comes in File, with its parity on top. `flipped` is high two cycles after a
// read_word of which an odd number of bits has flipped. A word is written a cycle later: trees of parity are slow.

`default_nettype none

module td_banked_table #(
  parameter int Width = 24,
  parameter int Depth = 256,
  parameter int Style = 1,  // of both memories, see td_ram.sv
  parameter     File  = "",
  parameter int Parity = 0,
  localparam int AddressWidth = $clog2(Depth),
  localparam int StoredWidth  = Width + Parity
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     en,
  input  wire                     table_bank,
  output logic                    table_in_use,
  input  wire                     frame_start,
  input  wire                     change,
  input  wire                     read,
  input  wire  [AddressWidth-1:0] read_address,
  output logic [Width-1:0]        read_word,
  input  wire                     free_write,
  input  wire  [AddressWidth-1:0] free_write_address,
  input  wire  [Width-1:0]        free_write_word,
  input  wire                     free_read,
  input  wire  [AddressWidth-1:0] free_read_address,
  output logic [Width-1:0]        free_word,
  output logic                    flipped
);

  logic bank, named, used;  // in use; named for the frame that comes; in use in this cycle
  logic [1:0][StoredWidth-1:0] words;
  logic [StoredWidth-1:0] word_in_use;
  assign used = (en & change) ? named : bank;
  assign table_in_use = bank;
  assign word_in_use = words[bank];
  assign read_word = word_in_use[Width-1:0];
  assign free_word = Width'(words[~bank]);
  always_ff @(posedge clk) begin
    if (rst || (en && frame_start)) named <= table_bank;
    bank <= rst ? table_bank : used;
  end

  logic [1:0] free_writes, writes;  // of each bank
  logic [AddressWidth-1:0] write_address;
  logic [StoredWidth-1:0] write_word;
  assign free_writes = {free_write & ~bank, free_write & bank};
  if (Parity == 0) begin : g_plain
    assign writes = free_writes;
    assign write_address = free_write_address;
    assign write_word = free_write_word;
    assign flipped = 1'b0;
  end else begin : g_parity
    logic [1:0] writes_q = 2'b00;  // a cycle before the first reset writes nothing
    logic [Width-1:0] word_q;
    logic [StoredWidth-1:0] checked;
    assign writes = writes_q;
    assign write_word = {^word_q, word_q};
    always_ff @(posedge clk) begin
      writes_q <= free_writes;
      write_address <= free_write_address;
      word_q <= free_write_word;
      checked <= word_in_use;
      flipped <= ^checked;
    end
  end

  for (genvar b = 0; b < 2; b++) begin : g_bank
    logic in_use;
    assign in_use = used == 1'(b);
    td_ram #(.Width(StoredWidth), .Depth(Depth), .Style(Style), .File(File)) u_ram (
      .clk,
      .write_en     (writes[b]),
      .write_address,
      .write_data   (write_word),
      .read_en      (in_use ? en & read : free_read),
      .read_address (in_use ? read_address : free_read_address),
      .read_data    (words[b])
    );
  end

endmodule

`default_nettype wire
