// SPDX-License-Identifier: Apache-2.0
// fv_twiddle_multiply: an arbitrary word meets the ROM word of its own position modulo Block and leaves 7 enabled
// clocks later; start and frame_start likewise. The words are 1 or j, so that what leaves is the factor itself, and
// every field of it is seen; the exact product is proven of td_dot_product, rounding of td_round_saturate.

`default_nettype none

module fv_twiddle_multiply #(
  parameter int Size     = 8,
  parameter int Block    = 4,
  parameter int RealOnly = 0,
  localparam int PositionWidth = $clog2(Size)
) (
  input logic clk,
  input logic rst,
  input logic en,
  input logic go,
  input logic restart,
  input logic turned,
  input logic pick
);

  localparam int Latency = 7;
  localparam int CoeffWidth = 5;
  localparam int OutWidth = 8;

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  logic in_start, in_frame_start, active, last_row;
  logic [PositionWidth-1:0] position;
  logic [1:0] row;
  burst_source #(.Columns(Size), .Rows(2)) u_source (
    .clk, .rst, .en, .go, .restart, .start(in_start), .frame_start(in_frame_start), .active, .position, .row, .last_row
  );

  logic out_start, out_frame_start;
  logic signed [OutWidth-1:0] out_re, out_im;
  logic [1:0] saturations;
  twiddle_multiply #(
    .InWidth(2), .OutWidth(OutWidth), .CoeffWidth(CoeffWidth), .Drop(0), .Size(Size), .Block(Block),
    .RealOnly(RealOnly), .File("factors.hex")
  ) dut (
    .clk, .rst, .en, .in_start, .in_frame_start, .in_re(turned ? 2'd0 : 2'd1), .in_im(turned ? 2'd1 : 2'd0),
    .out_start, .out_frame_start, .out_re, .out_im, .saturations
  );

  logic [3*CoeffWidth-1:0] factors[Block];
  initial $readmemh("factors.hex", factors);
  logic signed [CoeffWidth-1:0] w_re, w_im, w_minus_im;
  assign {w_minus_im, w_im, w_re} = factors[32'(position) % Block];

  logic following, held;
  logic [2:0] age;
  logic signed [OutWidth-1:0] re, im;
  logic [2*OutWidth+1:0] out_q;
  always_ff @(posedge clk) begin
    started <= 1'b1;
    held <= ~en & ~rst;
    out_q <= {out_start, out_frame_start, out_re, out_im};
    if (en) begin
      if (!following || age == 3'(Latency)) begin
        following <= pick & active;
        age <= 3'd1;
        re <= turned ? OutWidth'(w_minus_im) : OutWidth'(w_re);
        im <= RealOnly != 0 ? '0 : turned ? OutWidth'(w_re) : OutWidth'(w_im);
      end else begin
        age <= age + 3'd1;
      end
    end
    if (rst) following <= 1'b0;
  end

  burst_timing #(.Columns(Size), .Latency(Latency)) u_timing (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .out_frame_start
  );
  always_comb begin
    if (started) begin
      if (following && age == 3'(Latency)) own_factor: assert (out_re == re && out_im == im);
      if (held) holds: assert ({out_start, out_frame_start, out_re, out_im} == out_q);
      none_clipped: assert (saturations == '0);
      last_word: cover (following && age == 3'(Latency) && held
          && re == OutWidth'($signed(factors[Block-1][CoeffWidth-1:0])));
    end
  end

endmodule

`default_nettype wire
