// SPDX-License-Identifier: Apache-2.0
// td_ramp: words an equal step apart, from the first of them.
//
//   out[n] = first + n step,  n = 0 .. Count - 1, modulo 2^Width
//
// A binary tree with a register in each level: the branches of a node are its word, and the word half its span later.
// So it takes Count - 1 adders, whatever step is. Latency: log2(Count) cycles with en; with one word 0.
// Bit-accurate model: models/tactile_depth/chip/common/td_ramp.py.

`default_nettype none

module td_ramp #(
  parameter int Width     = 32,
  parameter int StepWidth = 29,
  parameter int Count     = 4,  // a power of two
  localparam int Levels = $clog2(Count)
) (
  input  wire                        clk,
  input  wire                        en,
  input  wire  [Width-1:0]           first,
  input  wire  signed [StepWidth-1:0] step,
  output logic [Count*Width-1:0]     out     // the first in the lowest bits
);

  for (genvar l = 0; l <= Levels; l++) begin : g_level
    logic [(1<<l)*Width-1:0] words;  // 2^l of them, Count / 2^l steps apart
    if (l == 0) begin : g_first
      assign words = first;
    end else begin : g_next
      logic signed [StepWidth-1:0] apart;  // the step, when the words of level l - 1 are there
      if (l == 1) begin : g_now
        assign apart = step;
      end else begin : g_later
        always_ff @(posedge clk) if (en) apart <= g_level[l-1].g_next.apart;
      end
      for (genvar n = 0; n < 1 << l; n++) begin : g_word
        logic [Width-1:0] word, add;
        assign word = g_level[l-1].words[n/2*Width+:Width];
        assign add = n % 2 == 0 ? '0 : Width'(apart) <<< (Levels - l);
        always_ff @(posedge clk) if (en) words[n*Width+:Width] <= word + add;
      end
    end
  end
  assign out = g_level[Levels].words;

  if (Count < 1 || Count != (1 << Levels)) begin : g_refused_0
    Count_must_be_a_power_of_two u_refused ();
  end
  if (StepWidth > Width) begin : g_refused_1
    StepWidth_must_be_at_most_Width u_refused ();
  end

endmodule

`default_nettype wire
