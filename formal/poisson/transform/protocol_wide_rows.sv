// SPDX-License-Identifier: Apache-2.0
// protocol_wide_rows: single words go in; bursts of Columns / Paths beats go out, 2 enabled clocks behind their start.

`default_nettype none

module protocol_wide_rows #(
  parameter int Columns = 8,
  parameter int Paths   = 2
) (
  input  logic clk,
  input  logic rst,
  input  logic en,
  input  logic in_valid,
  input  logic in_frame_start,
  input  logic out_start,
  output logic holds,
  output logic counts_out_start,
  output logic counts_out_frame_start,
  output logic counts
);

  logic [1:0] start_q;
  logic unused_saturations;
  always_ff @(posedge clk) begin
    if (en) start_q <= {start_q[0], out_start};
    if (rst | ~holds) start_q <= '0;
  end
  protocol_words #(.Columns(Columns), .Lanes(Paths)) u_words (
    .clk, .rst, .en, .in_valid, .in_frame_start, .out_start(start_q[1]), .holds,
    .counts_out_start, .counts_out_frame_start, .counts_saturations(unused_saturations), .counts
  );

endmodule

`default_nettype wire
