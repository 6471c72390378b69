// SPDX-License-Identifier: Apache-2.0
// fv_reference_capture: a capture begins with the first whole frame behind a request, takes 2^k good frames in a row,
// and is done a fixed number of clocks behind the last of them; no node is read before it was written, or in the clock
// that writes it, and nothing is written while idle. In a second part (Sums 1): an arbitrary pixel of a capture, the
// only one that is not black, is added once to its node and to no other; what does nothing but add does so to all.
//
// Of the three colours, red; the quotients are left to simulation.

parameter int Rows = 3, Columns = 4, MaxLog2 = 1, Sums = 0;
localparam int Width = 8 + 2 + MaxLog2, BlockLog2 = 1, GainFraction = Width;
input logic [NodeWidth-1:0] chosen;

localparam int Clocks = Nodes * (6 + 3 * (Width + 3)) + 2;  // from the last pixel to done
localparam int Summed = 6;                                  // to the last sum in its place

logic [3*Width-1:0] gains;
assign map_read_gains = gains;
td_ram #(.Width(3 * Width), .Depth(Nodes)) u_ram (
  .clk, .write_en(map_write), .write_address(map_write_node), .write_data(map_write_gains),
  .read_en(map_read), .read_address(map_read_node), .read_data(gains)
);
ram_check #(.Depth(Nodes)) u_check (
  .clk, .write_en(map_write), .write_address(map_write_node), .read_en(map_read), .read_address(map_read_node)
);

wire [15:0] row = u_protocol.row, column = u_protocol.column;
typedef enum logic [1:0] {Idle, Armed, Summing, Dividing} state_e;
state_e state;
logic [NodeWidth-1:0] watched;  // chosen in the first clock, then constant
logic [MaxLog2:0] wanted, wanted_next;
logic [Width-1:0] held_sum;  // of the watched node, as the memory holds it
logic seen, seen_here;       // the pixel, in the frames that count; at the watched node
logic first, last, counts, in_watched;
logic [8:0] to_done;
assign first = en && in_valid && in_position[1:0] == 2'b11;
assign last = en && in_valid && in_position[3:2] == 2'b11;
assign counts = en && in_valid && (state == Summing || state == Armed && first);
assign in_watched = 32'(row) < Rows / 2 * 2 && 32'(row) / 2 * (Columns / 2) + 32'(column) / 2 == 32'(watched);
assign wanted_next = (MaxLog2 + 1)'(1) << (32'(log2_frames) > MaxLog2 ? 4'(MaxLog2) : log2_frames);
always_ff @(posedge clk) begin
  if (!started) watched <= chosen;
  if (map_write && map_write_node == watched) held_sum <= map_write_gains[Width-1:0];
  if (first && state == Armed) begin
    state <= Summing;
    wanted <= wanted_next;
  end
  if (counts) begin
    seen <= (seen && !(first && state == Armed)) || in_pixel[16];
    seen_here <= (seen_here && !(first && state == Armed)) || (in_watched && in_pixel[16]);
  end
  if (last && state == Summing) begin
    wanted <= wanted - (MaxLog2 + 1)'(1);
    if (in_bad) state <= Armed;
    else if (wanted == (MaxLog2 + 1)'(1)) begin
      state <= Dividing;
      to_done <= 9'(Clocks - 1);
    end
  end
  if (state == Dividing) begin
    to_done <= to_done - 9'd1;
    if (to_done == '0) state <= Idle;
  end
  if (request) state <= Armed;
  if (rst) state <= Idle;
end

always_comb begin
  assume ((in_pixel & ~24'h010000) == '0);
  if (counts && seen && !(first && state == Armed)) assume (!in_pixel[16]);
end

// Clocks of a node so far: six to fetch it, then for each gain one to start the divider, which counts its bits down.
localparam int FetchSteps = 6, GainSteps = Width + 3;
localparam int Fetching = 3, Divides = 4;  // states of the core
logic in_step, fetches, starts, divides;
int steps;
assign fetches = dut.state == 3'(Fetching) && !dut.divide_start && !dut.u_divide.dividing;
assign starts = dut.state == 3'(Divides) && dut.divide_start && !dut.u_divide.dividing && !dut.gains_valid;
assign divides = dut.state == 3'(Divides) && !dut.divide_start && dut.u_divide.dividing && !dut.gains_valid;
always_comb begin
  steps = (32'(dut.divide_node) + 32'(dut.gains_valid)) * (FetchSteps + 3 * GainSteps);
  if (fetches) steps = steps + 32'(dut.step);
  else steps = steps + FetchSteps + 32'(dut.channel) * GainSteps;
  if (divides) steps = steps + GainSteps - 1 - 32'(dut.u_divide.bits_to_come);
  in_step = 32'(to_done) == Clocks - 1 - steps && (fetches || ((starts || divides) && 32'(dut.channel) < 3))
      && !(dut.gains_valid && dut.step != '0) && !(fetches && 32'(dut.step) >= FetchSteps)
      && !(divides && 32'(dut.u_divide.bits_to_come) >= GainSteps - 1);
end

always_comb begin
  if (started) begin
    if (Sums == 0) begin
      // The divider's progress by its own counters, so that the proof needs no search for it.
      when: assert (busy == (state != Idle) && done == (state == Dividing && to_done == '0)
          && (state != Dividing || to_done == '0 || in_step) && (state != Idle || !map_write));
    end else begin
      if (state == Dividing && to_done == 9'(Clocks - Summed)) sums: assert (held_sum == Width'(seen_here));
      added: cover (state == Dividing && to_done == 9'(Clocks - Summed) && seen_here);
    end
    afresh: cover (request && state == Dividing);
  end
end
