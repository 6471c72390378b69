// SPDX-License-Identifier: Apache-2.0
// fv_self_check: a verdict comes 18 + log2(Lanes) clocks after the last depths of a frame, enabled or not, and at no other
// time; `beyond` is what the residual says; both stay until the next verdict. Any depths and any divergence, at any time; rows without a gap or apart, frames that are cut short, any en.

parameter int Rows = 3, Columns = 32, Lanes = 1;
localparam int InWidth = 3, Width = 3, InDropped = 1, Dropped = 1, Scale = 1, ScaleFraction = 1, SumWidth = 4, Bound = 3;
localparam int FrameLatency = 64;

localparam int Latency = 18 + $clog2(Lanes);

logic [Latency-1:0] due;  // due[n]: the last depths of a frame were there n + 1 clocks ago
logic [SumWidth-1:0] verdict_q;
logic judges, held;
assign judges = due[Latency-2];
always_ff @(posedge clk) begin
  due <= Latency'({due, en & u_protocol.ends});
  if (rst) due <= '0;
  verdict_q <= {residual, beyond};
  held <= started & ~judges & ~rst;
end

always_comb begin
  if (started) begin
    when_due: assert (dut.ends_frame_q[5] == due[Latency-2]);
    judged: assert (beyond == (32'(residual) > Bound));
    if (held) stays: assert ({residual, beyond} == verdict_q);
    without_en: cover (judges && !en);
  end
end

// Protocol: rows of depths in successive enabled clocks, Rows of them a frame.
module protocol_self_check;
  localparam int Beats = Columns / Lanes;
  logic active, last_row, bursts_hold, ends;
  logic [$clog2(Beats)-1:0] position;
  protocol_bursts #(.Columns(Beats), .Rows(Rows)) u_bursts (
    .clk, .rst, .en, .in_start(out_start), .in_frame_start(out_frame_start), .out_start(1'b0), .active, .position,
    .row(), .last_row, .holds(bursts_hold), .counts_out_start(), .counts_out_frame_start(), .counts_saturations(),
    .counts()
  );
  assign ends = active & last_row & (32'(position) == Beats - 1);
  assign holds = bursts_hold & (~in_frame_start | in_valid);
  assign counts = live & ~reset;
endmodule
