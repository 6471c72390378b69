// SPDX-License-Identifier: Apache-2.0
// td_parity_rom: a td_rom with a parity bit in each word, and with a register behind it.
//
// Data leaves Latency enabled cycles after its address, 1 or 2. `flipped` is high two cycles later, while an odd number
// of bits of that word differs from the File, whose words have their parity on top. Parity 0: no bit more, and
// `flipped` is low. Bit-accurate model: models/tactile_depth/chip/common/td_parity_rom.py.

`default_nettype none

module td_parity_rom #(
  parameter int Width   = 54,
  parameter int Depth   = 128,
  parameter int Style   = 3,  // see td_rom.sv
  parameter     File    = "rom.hex",
  parameter int Latency = 1,
  parameter int Parity  = 0,
  localparam int AddressWidth = $clog2(Depth)
) (
  input  wire                     clk,
  input  wire                     en,
  input  wire  [AddressWidth-1:0] address,
  output logic [Width-1:0]        data,
  output logic                    flipped
);

  localparam int StoredWidth = Width + Parity;

  logic [StoredWidth-1:0] word, word_out;
  td_rom #(.Width(StoredWidth), .Depth(Depth), .Style(Style), .File(File)) u_rom (.clk, .en, .address, .data(word));
  if (Latency == 1) begin : g_straight
    assign word_out = word;
  end else begin : g_register
    always_ff @(posedge clk) if (en) word_out <= word;
  end
  assign data = word_out[Width-1:0];
  if (Parity == 0) begin : g_plain
    assign flipped = 1'b0;
  end else begin : g_parity
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
