// SPDX-License-Identifier: Apache-2.0
// protocol_beat_sums: any inputs; limits and peak count where something is above.

`default_nettype none

module protocol_beat_sums #(
  parameter int Lanes = 8
) (
  input  logic [$clog2(Lanes):0] count,
  output logic                   counts_peak,
  output logic                   counts_peak_offset,
  output logic                   counts_least_offset,
  output logic                   counts_greatest_offset
);

  assign {counts_peak, counts_peak_offset, counts_least_offset, counts_greatest_offset} = {4{count != '0}};

endmodule

`default_nettype wire
