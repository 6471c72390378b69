// SPDX-License-Identifier: Apache-2.0
// fv_td_ram: a read returns what was last written to its address, in every style; it holds while read_en is low.
//
// One arbitrary address is watched. What the protocol asks is proven of every core that uses a ram (ram_check).

parameter int Width = 1, Depth = 6, Style = 1;
input logic [AddressWidth-1:0] chosen;

always_comb assume (u_protocol.allowed && 32'(chosen) < Depth);

logic started = 1'b0;
logic known = 1'b0, rewritten = 1'b0, returned = 1'b0, held = 1'b0;
logic [AddressWidth-1:0] watched;  // chosen in the first clock, then constant
logic [Width-1:0] value, expected, read_data_q;
always_ff @(posedge clk) begin
  started <= 1'b1;
  if (!started) watched <= chosen;
  else begin
    if (write_en && write_address == watched) begin
      known <= 1'b1;
      rewritten <= known;
      value <= write_data;
    end
    returned <= read_en & (read_address == watched) & known;
    expected <= value;
    held <= ~read_en;
    read_data_q <= read_data;
  end
end

always_comb begin
  if (returned) last_written: assert (read_data == expected);
  if (held) holds: assert (read_data == read_data_q);
  read_again: cover (returned && rewritten && value != read_data_q);
end
