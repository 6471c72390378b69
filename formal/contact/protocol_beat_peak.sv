// SPDX-License-Identifier: Apache-2.0
// protocol_beat_peak: any inputs; the peak counts where something is above.

`default_nettype none

module protocol_beat_peak (
  input  logic any,
  output logic counts_peak,
  output logic counts_peak_offset
);

  assign {counts_peak, counts_peak_offset} = {2{any}};

endmodule

`default_nettype wire
