// SPDX-License-Identifier: Apache-2.0
// td_delay_line: delays a word by Delay enabled cycles: registers, or a memory if the delay is long.
//
// Time moves with en alone, not with the data: what is inside drains by itself. The pointer of the memory
// runs round. Bit-accurate model: models/tactile_depth/chip/common/td_delay_line.py.

`default_nettype none

module td_delay_line #(
  parameter int Width = 54,
  parameter int Delay = 64,
  parameter int Style = 3,  // of a memory, 0, 1 or 3: see td_ram.sv; 4: registers, however long the delay is
  parameter int Parity = 0  // of a memory or of Style 4, see td_parity_ram.sv
) (
  input  wire              clk,
  input  wire              rst,
  input  wire              en,
  input  wire  [Width-1:0] in,  // a word of any format
  output logic [Width-1:0] out,
  output logic             flipped
);

  localparam int LongestShift = 4;

  if (Delay <= LongestShift || Style == 4) begin : g_shift
    localparam int StoredWidth = Style == 4 ? Width + Parity : Width;
    logic [StoredWidth-1:0] comes;
    logic [Delay-1:0][StoredWidth-1:0] taps;  // the oldest word on top
    if (Delay == 1) begin : g_one
      always_ff @(posedge clk) if (en) taps <= comes;
    end else begin : g_many
      always_ff @(posedge clk) if (en) taps <= {taps[Delay-2:0], comes};
    end
    assign out = taps[Delay-1][Width-1:0];
    if (StoredWidth == Width) begin : g_plain
      assign comes = in;
      assign flipped = 1'b0;
    end else begin : g_parity
      assign comes = {^in, in};
      always_ff @(posedge clk) flipped <= ^taps[Delay-1];
    end
  end else begin : g_memory
    // The word read now leaves the read register one cycle later: it is the one written Depth - 1 cycles ago. A block
    // memory is slow, so a register is behind it; a tree of parity is slow, so one is before it.
    localparam bit Block = Style == 1 || (Style == 3 && Width * Delay > td_memory_pkg::DistributedBits);
    localparam int Depth = Delay - int'(Block) - Parity;
    localparam int AddressWidth = $clog2(Depth);
    logic [AddressWidth-1:0] pointer;
    logic [AddressWidth-1:0] pointer_next;
    logic [Width-1:0] written;
    assign pointer_next = (pointer == AddressWidth'(Depth - 1)) ? '0 : pointer + AddressWidth'(1);
    td_parity_ram #(
      .Width(Width), .Depth(Depth), .Style(Block ? 1 : 0), .Latency(Block ? 2 : 1), .Parity(Parity)
    ) u_ram (
      .clk, .en, .write_en(en), .write_address(pointer), .write_data(written),
      .read_en(en), .read_address(pointer_next), .read_data(out), .flipped
    );
    if (Parity == 0) begin : g_straight
      assign written = in;
    end else begin : g_register
      always_ff @(posedge clk) if (en) written <= in;
    end
    always_ff @(posedge clk) begin
      if (en) pointer <= pointer_next;
      if (rst) pointer <= '0;
    end
  end

  if (Delay < 1) begin : g_refused
    Delay_must_be_at_least_1 u_refused ();
  end

endmodule

`default_nettype wire
