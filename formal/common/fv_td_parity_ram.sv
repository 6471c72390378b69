// SPDX-License-Identifier: Apache-2.0
// fv_td_parity_ram: the word that was last written to an address leaves and is not called flipped; a word in the memory
// with any bits is called flipped if an odd number of them differs from a word that was written.
//
// One arbitrary address is watched; its word before the first write is arbitrary too.

parameter int Width = 3, Depth = 6, Style = 1, Latency = 1, Parity = 1;
input logic [AddressWidth-1:0] chosen;

always_comb assume (u_protocol.allowed && 32'(chosen) < Depth);

logic started = 1'b0, written = 1'b0;
logic [AddressWidth-1:0] watched;  // chosen in the first clock, then constant
logic [Width:0] stored;
logic [1:0] present = '0, present_written = '0;  // behind the memory, in the register behind that
logic [1:0][Width:0] present_word;
logic [1:0] shown_q = '0, shown_written_q = '0, shown_odd_q;  // one and two clocks ago
always_ff @(posedge clk) begin
  started <= 1'b1;
  if (!started) begin
    watched <= chosen;
    stored <= write_en && write_address == chosen ? {^write_data, write_data} : dut.u_ram.g_block.words[chosen];
    written <= write_en & write_address == chosen;
  end else begin
    if (write_en && write_address == watched) begin
      written <= 1'b1;
      stored <= {^write_data, write_data};
    end
    if (read_en) begin
      present[0] <= read_address == watched;
      present_written[0] <= written;
      present_word[0] <= stored;
    end
    if (en) begin
      present[1] <= present[0];
      present_written[1] <= present_written[0];
      present_word[1] <= present_word[0];
    end
    shown_q <= {shown_q[0], present[Latency-1]};
    shown_written_q <= {shown_written_q[0], present_written[Latency-1]};
    shown_odd_q <= {shown_odd_q[0], ^present_word[Latency-1]};
  end
end

always_comb begin
  if (present[Latency-1]) as_stored: assert (read_data == present_word[Latency-1][Width-1:0]);
  if (shown_q[1]) odd: assert (flipped == shown_odd_q[1]);
  if (shown_q[1] && shown_written_q[1]) as_written: assert (!flipped);
  flip_seen: cover (shown_q[1] && flipped);
  read_again: cover (shown_q[1] && shown_written_q[1] && present[Latency-1] && read_data != '0);
end

bind dut.u_ram ram_check #(.Depth(Depth), .Defined(0)) u_check (.*);

// Protocol: no word is read in the clock that writes it.
module protocol_td_parity_ram;
  assign holds = ~(read_en & write_en & read_address == write_address)
      & (~read_en | 32'(read_address) < Depth) & (~write_en | 32'(write_address) < Depth);
endmodule
