// SPDX-License-Identifier: Apache-2.0
// fv_frame_tags: an arbitrary tag is due exactly Latency enabled clocks after it was pushed, unchanged, and nothing
// else is ever due; held is high just while there are tags. Pushes come at least Pixels enabled clocks apart, else at
// any time.

`default_nettype none

module fv_frame_tags #(
  parameter int Width   = 1,
  parameter int Latency = 10,
  parameter int Pixels  = 4
) (
  input logic             clk,
  input logic             rst,
  input logic             en,
  input logic             offer,
  input logic [Width-1:0] tag,
  input logic             pick
);

  localparam int AgeWidth = $clog2(Latency + 1);
  localparam int WaitWidth = $clog2(Pixels + 1);

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  logic push, due, held;
  logic [Width-1:0] due_tag;
  logic [WaitWidth-1:0] wait_for;  // enabled clocks until the next push may come
  assign push = offer & (wait_for == '0);
  frame_tags #(.Width(Width), .Latency(Latency), .Pixels(Pixels)) dut (
    .clk, .rst, .en, .push, .tag, .due, .due_tag, .held
  );

  logic [Latency-1:0] pushed;
  logic following;
  logic [AgeWidth-1:0] age;
  logic [Width-1:0] value;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    if (en) begin
      pushed <= Latency'({pushed, push});
      if (push) wait_for <= WaitWidth'(Pixels - 1);
      else if (wait_for != '0) wait_for <= wait_for - WaitWidth'(1);
      if (!following || age == AgeWidth'(Latency)) begin
        following <= pick & push;
        age <= AgeWidth'(1);
        value <= tag;
      end else begin
        age <= age + AgeWidth'(1);
      end
    end
    if (rst) begin
      pushed <= '0;
      wait_for <= '0;
      following <= 1'b0;
    end
  end

  int tags;  // on their way
  always_comb begin
    tags = 0;
    for (int i = 0; i < Latency; i++) tags += 32'(pushed[i]);
  end

  always_comb begin
    if (started) begin
      due_just_then: assert (due == pushed[Latency-1]);
      if (following && age == AgeWidth'(Latency)) own_tag: assert (due && due_tag == value);
      held_meanwhile: assert (held == (pushed != '0));
      most_tags: cover (tags == (Latency + Pixels - 1) / Pixels && due);
      alone: cover (due && en && pushed[Latency-2:0] == '0);
    end
  end

endmodule

`default_nettype wire
