// SPDX-License-Identifier: Apache-2.0
// td_axis_skid: register slice of a ready/valid stream, two words deep.
//
// Stream in, stream out: the same words in the same order. Latency: 1 cycle, one word a cycle sustained. Every output,
// s_ready too, comes from a register: no combinational path crosses it. It never waits for s_valid to raise s_ready.
// Cycle-accurate model: models/tactile_depth/chip/common/td_axis_skid.py, a queue.

`default_nettype none

module td_axis_skid #(
  parameter int Width = 26
) (
  input  wire              clk,
  input  wire              rst,
  input  wire              s_valid,
  output logic             s_ready,
  input  wire  [Width-1:0] s_data,
  output logic             m_valid,
  input  wire              m_ready,
  output logic [Width-1:0] m_data
);

  logic [Width-1:0] waiting;  // taken while the output was stalled; there is one when m_valid is high and s_ready low
  logic leave;
  assign leave = m_ready | ~m_valid;

  always_ff @(posedge clk) begin
    if (s_ready) waiting <= s_data;
    if (leave) begin
      m_data <= s_ready ? s_data : waiting;
      m_valid <= s_ready ? s_valid : m_valid;
      s_ready <= 1'b1;
    end else if (s_valid) begin
      s_ready <= 1'b0;
    end
    if (rst) begin
      m_valid <= 1'b0;
      s_ready <= 1'b0;
    end
  end

endmodule

`default_nettype wire
