// SPDX-License-Identifier: Apache-2.0
// depth_signature: the signature of the depth codes of a self-test.
//
//   signature = signature_step( .. signature_step( signature_step( all ones, code 0 ), code 1 ) .. )   of td_types_pkg
//
// over the codes of a frame in the order in which they leave, each sign-extended to 32 bits. It is shown from the
// frame's end to the next `clear` or start of a frame; else 0. Stream in: beats of Lanes codes of the frame of a
// self-test, and of no other. Latency: 2 cycles; a gap or en low changes nothing. Model:
// models/tactile_depth/chip/depth/depth_signature.py.

`default_nettype none

module depth_signature
  import td_types_pkg::*;
#(
  parameter int Width = 24,
  parameter int Lanes = 1  // codes of a beat, a power of two
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    en,
  input  wire                    clear,
  input  wire                    in_valid,
  input  wire                    in_frame_start,
  input  wire                    in_frame_end,
  input  wire  [Lanes*Width-1:0] in_data,   // depth codes, signed
  output logic [31:0]            signature  // 0: none
);

  function automatic logic [31:0] behind(input logic [31:0] word, input int steps);
    behind = word;
    for (int n = 0; n < steps; n++) behind = signature_step(behind, '0);
  endfunction

  // A step is linear: the codes of a beat are folded two by two into a word, before they meet the sum of those before.
  for (genvar l = 0; l <= $clog2(Lanes); l++) begin : g_level
    logic [(Lanes>>l)-1:0][31:0] words;
    for (genvar n = 0; n < Lanes >> l; n++) begin : g_word
      if (l == 0) begin : g_code
        assign words[n] = 32'($signed(in_data[n*Width+:Width]));
      end else begin : g_pair
        assign words[n] = behind(g_level[l-1].words[2*n], 1 << (l - 1)) ^ g_level[l-1].words[2*n+1];
      end
    end
  end

  logic beat, starts, ends, complete;
  logic [31:0] folded, sum;
  assign signature = complete ? sum : '0;
  always_ff @(posedge clk) begin
    beat <= en & in_valid & ~rst;
    {starts, ends} <= {in_frame_start, in_frame_end};
    folded <= g_level[$clog2(Lanes)].words;
    if (beat) begin
      sum <= behind(starts ? '1 : sum, Lanes) ^ folded;
      complete <= ends;
    end
    if (rst || clear) complete <= 1'b0;
  end

endmodule

`default_nettype wire
