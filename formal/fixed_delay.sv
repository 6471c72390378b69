// SPDX-License-Identifier: Apache-2.0
// fixed_delay: a word that comes with in_valid leaves Latency enabled clocks later, and nothing else leaves; while en is
// low it stays. `active` is high just while a word is inside.
//
// Bit n - 1 of `valid`: a word came n enabled clocks ago. `held`: the clock before had neither an enable nor a reset.

`default_nettype none

module fixed_delay #(
  parameter int Latency = 2
) (
  input  logic               clk,
  input  logic               rst,
  input  logic               en,
  input  logic               in_valid,
  input  logic               in_data,
  input  logic               out_valid,
  input  logic               out_data,
  input  logic               active,
  output logic [Latency-1:0] valid,
  output logic               held
);

  logic started = 1'b0;
  logic [Latency-1:0] data;
  logic [1:0] out_q;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    held <= ~en & ~rst;
    out_q <= {out_valid, out_data};
    if (en) begin
      valid <= {valid[Latency-2:0], in_valid};
      data <= {data[Latency-2:0], in_data};
    end
    if (rst) valid <= '0;
  end

  always_comb begin
    if (started) begin
      valid_travels: assert (out_valid == valid[Latency-1]);
      if (out_valid) data_travels: assert (out_data == data[Latency-1]);
      word_inside: assert (active == (valid != '0));
      if (held) stays: assert ({out_valid, out_data} == out_q);
    end
  end

endmodule

`default_nettype wire
