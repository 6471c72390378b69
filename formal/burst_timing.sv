// SPDX-License-Identifier: Apache-2.0
// burst_timing: bursts come as protocol_bursts allows them; start and frame_start leave with the burst they came with,
// Latency enabled clocks later, and no others.

`default_nettype none

module burst_timing #(
  parameter int Columns = 8,
  parameter int Rows    = 0,
  parameter int Latency = 23,
  localparam int PositionWidth = $clog2(Columns),
  localparam int RowWidth = Rows > 0 ? $clog2(Rows + 1) : 1
) (
  input  logic                     clk,
  input  logic                     rst,
  input  logic                     en,
  input  logic                     in_start,
  input  logic                     in_frame_start,
  input  logic                     out_start,
  input  logic                     out_frame_start,
  output logic                     started,
  output logic                     active,  // a word is present, with this position in its burst
  output logic [PositionWidth-1:0] position,
  output logic [RowWidth-1:0]      row      // of the burst in its frame
);

  logic allowed;
  protocol_bursts #(.Columns(Columns), .Rows(Rows)) u_protocol (
    .clk, .rst, .en, .in_start, .in_frame_start, .out_start, .active, .position, .row, .holds(allowed)
  );
  assumed u_assumed (.*);

  logic [Latency-1:0] start_q, frame_start_q;
  always_ff @(posedge clk) begin
    if (en) begin
      start_q <= Latency'({start_q, in_start});
      frame_start_q <= Latency'({frame_start_q, in_frame_start});
    end
    if (rst) begin
      start_q <= '0;
      frame_start_q <= '0;
    end
  end

  always_comb begin
    if (started) begin
      start_when_due: assert (out_start == start_q[Latency-1]);
      frame_start_when_due: assert (out_frame_start == frame_start_q[Latency-1]);
    end
  end
  if (Latency > Columns) begin : g_next
    always_comb begin
      if (started) begin
        next_burst_behind: cover (out_start && !out_frame_start && start_q[Latency-Columns-1] && en);
        next_frame: cover (out_frame_start && start_q[Columns-1:0] == '0);
      end
    end
  end

endmodule

`default_nettype wire
