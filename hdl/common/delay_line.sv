// SPDX-License-Identifier: Apache-2.0
// delay_line: out is in, Delay enabled clocks later.
//
// Time moves with en alone, not with the data: what is inside drains by itself. Short lines are registers, long ones a
// memory whose pointer runs round. Bit-accurate model: models/tactile_depth/common/delay_line.py.

module delay_line #(
  parameter int Width = 54,
  parameter int Delay = 64
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic [Width-1:0] in,
  output logic [Width-1:0] out
);

  localparam int LongestShift = 4;
  localparam int BlockBits = 4096;

  if (Delay <= LongestShift) begin : g_shift
    logic [Delay*Width-1:0] taps;  // the oldest word on top
    if (Delay == 1) begin : g_one
      always_ff @(posedge clk) if (en) taps <= in;
    end else begin : g_many
      always_ff @(posedge clk) if (en) taps <= {taps[(Delay-1)*Width-1:0], in};
    end
    assign out = taps[Delay*Width-1-:Width];
    logic unused_rst;
    assign unused_rst = rst;
  end else begin : g_memory
    // The word read now leaves the read register one clock later: it is the one written Delay - 1 clocks ago.
    localparam int AddressWidth = $clog2(Delay);
    logic [AddressWidth-1:0] pointer;
    logic [AddressWidth-1:0] pointer_next;
    assign pointer_next = (pointer == AddressWidth'(Delay - 1)) ? '0 : pointer + AddressWidth'(1);
    ram #(
      .Width(Width),
      .Depth(Delay),
      .Style((Width * Delay > BlockBits) ? 1 : 0)
    ) u_ram (
      .clk          (clk),
      .write_en     (en),
      .write_address(pointer),
      .write_data   (in),
      .read_en      (en),
      .read_address (pointer_next),
      .read_data    (out)
    );
    always_ff @(posedge clk) begin
      if (en) pointer <= pointer_next;
      if (rst) pointer <= '0;
    end
  end

`ifndef SYNTHESIS
  initial if (Delay < 1) $fatal(1, "%m: Delay must be at least 1");
`endif

endmodule
