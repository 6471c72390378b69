// SPDX-License-Identifier: Apache-2.0
// td_parity_ram: a td_ram with a parity bit in each word, and with a register behind it.
//
// Latency 1: read_data is valid 1 cycle after a read. Latency 2: it is in a register, which takes the word that was
// read last in each cycle with en. `flipped` is high two cycles later, while an odd number of bits of that word differs
// from what was written; a word that was never written counts as any. Parity 0: no bit more, and `flipped` is low.
// A File holds words with their parity on top. Bit-accurate model:
// models/tactile_depth/chip/common/td_parity_ram.py.

`default_nettype none

module td_parity_ram #(
  parameter int Width   = 24,
  parameter int Depth   = 16384,
  parameter int Style   = 3,  // see td_ram.sv
  parameter     File    = "",
  parameter int Latency = 1,
  parameter int Parity  = 0,
  localparam int AddressWidth = $clog2(Depth)
) (
  input  wire                     clk,
  input  wire                     en,  // Latency 2
  input  wire                     write_en,
  input  wire  [AddressWidth-1:0] write_address,
  input  wire  [Width-1:0]        write_data,
  input  wire                     read_en,
  input  wire  [AddressWidth-1:0] read_address,
  output logic [Width-1:0]        read_data,
  output logic                    flipped
);

  localparam int StoredWidth = Width + Parity;

  logic [StoredWidth-1:0] write_word, word, word_out;
  td_ram #(.Width(StoredWidth), .Depth(Depth), .Style(Style), .File(File)) u_ram (
    .clk, .write_en, .write_address, .write_data(write_word), .read_en, .read_address, .read_data(word)
  );
  if (Latency == 1) begin : g_straight
    assign word_out = word;
  end else begin : g_register
    always_ff @(posedge clk) if (en) word_out <= word;
  end
  assign read_data = word_out[Width-1:0];
  if (Parity == 0) begin : g_plain
    assign write_word = write_data;
    assign flipped = 1'b0;
  end else begin : g_parity
    assign write_word = {^write_data, write_data};
    logic [StoredWidth-1:0] checked;  // behind a block memory a tree of gates comes too late
    always_ff @(posedge clk) begin
      checked <= word_out;
      flipped <= ^checked;
    end
  end

  if (Latency < 1 || Latency > 2) begin : g_refused_0
    Latency_must_be_1_or_2 u_refused ();
  end
  if (Parity < 0 || Parity > 1) begin : g_refused_1
    Parity_must_be_0_or_1 u_refused ();
  end

endmodule

`default_nettype wire
