// SPDX-License-Identifier: Apache-2.0
// follow_delay: an arbitrary word, picked as it comes in, is due Latency enabled clocks later; a reset loses it.

`default_nettype none

module follow_delay #(
  parameter int Width   = 1,
  parameter int Latency = 4
) (
  input  logic             clk,
  input  logic             rst,
  input  logic             en,
  input  logic             pick,  // free: follow the word that is present, if none is followed
  input  logic [Width-1:0] in,
  output logic             due,
  output logic [Width-1:0] word
);

  localparam int AgeWidth = $clog2(Latency + 1);
  logic following = 1'b0;
  logic [AgeWidth-1:0] age;  // enabled clocks since the word followed was present
  assign due = following & (age == AgeWidth'(Latency));
  always_ff @(posedge clk) begin
    if (en) begin
      if (!following || due) begin
        following <= pick;
        age <= AgeWidth'(1);
        word <= in;
      end else begin
        age <= age + AgeWidth'(1);
      end
    end
    if (rst) following <= 1'b0;
  end

endmodule

`default_nettype wire
