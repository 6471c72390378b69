// SPDX-License-Identifier: Apache-2.0
// event_registers: keeps what happened: sticky bits, counters, the last latency, and the interrupt; shows levels.
//
// A sticky bit of STATUS or INTERRUPT_STATUS is set by its event until a 1 is written to it. A counter counts the
// cycles in which its event is high, SATURATIONS the values clipped, and stays at all ones. LARGEST_RESIDUAL keeps the
// largest of the records. An event in the cycle of a clearing write is kept.
// `irq` is high in the cycle after one in which a bit of INTERRUPT_STATUS and its bit of interrupt_mask are 1.
// read_data is the word at read_offset in the same cycle, 0 where there is none.
// Model: models/tactile_depth/chip/registers/event_registers.py.

`default_nettype none

module event_registers
  import td_register_map_pkg::*;
  import td_types_pkg::*;
(
  input  wire          clk,
  input  wire          rst,
  input  wire          write,
  input  wire  [31:0]  write_offset,
  input  wire  [31:0]  write_ones,  // the data, 0 in bytes without strobe
  input  wire  [31:0]  read_offset,
  output logic [31:0]  read_data,

  input  wire events_t events,
  input  wire levels_t levels,
  input  wire  [31:0]  first_depth_latency,
  input  wire          first_depth_latency_valid,
  input  wire  [31:0]  interrupt_mask,
  output logic         irq
);

  faults_t faults;
  logic frame_dropped;
  assign faults = events.faults;
  assign frame_dropped = |faults;

  localparam logic [31:0] StatusBits = (32'd2 << StatusResidualBit) - 32'd1;  // the others are 0
  localparam logic [31:0] InterruptBits = (32'd2 << InterruptStatusResidualBit) - 32'd1;
  logic [31:0] status, status_set, status_shown, interrupts, interrupts_set, cleared, latency;
  assign status_set = (32'(faults.row_short) << StatusRowShortBit) | (32'(faults.row_long) << StatusRowLongBit)
    | (32'(faults.start_missing) << StatusStartMissingBit) | (32'(faults.start_early) << StatusStartEarlyBit)
    | (32'(faults.timed_out) << StatusTimeoutBit) | (32'(events.out_of_step) << StatusOutOfStepBit)
    | (32'(events.dark) << StatusDarkBit) | (32'(events.depth_dropped) << StatusDepthDroppedBit)
    | (32'(events.saturations != '0) << StatusSaturationBit) | (32'(events.flipped) << StatusFlippedBit)
    | (32'(events.residual) << StatusResidualBit);
  assign status_shown = status | (32'(levels.busy) << StatusBusyBit) | (32'(levels.contact) << StatusContactBit)
    | (32'(levels.touching) << StatusTouchingBit) | (32'(levels.hunting) << StatusHuntingBit)
    | (32'(levels.stalled) << StatusStalledBit);
  assign interrupts_set = (32'(events.record_valid) << InterruptStatusRecordBit)
    | (32'(frame_dropped) << InterruptStatusFrameDroppedBit)
    | (32'(events.flipped) << InterruptStatusFlippedBit)
    | (32'(events.residual) << InterruptStatusResidualBit);
  assign cleared = write ? write_ones : '0;
  always_ff @(posedge clk) begin
    status <= (status & StatusBits & ~(write_offset == StatusOffset ? cleared : '0)) | status_set;
    interrupts <= (interrupts & InterruptBits & ~(write_offset == InterruptStatusOffset ? cleared : '0))
        | interrupts_set;
    irq <= |(interrupts & interrupt_mask);
    if (first_depth_latency_valid) latency <= first_depth_latency;
    if (rst) {status, interrupts, irq, latency} <= '0;
  end

  localparam int Counters = 7;
  logic counters_cleared;
  logic [StepWidth*Counters-1:0] more;
  logic [32*Counters-1:0] counts;
  assign counters_cleared = write && write_offset == ControlOffset && write_ones[ControlClearCountersBit];
  assign more = {
    events.saturations, StepWidth'(events.record_lost), StepWidth'(events.depth_dropped), StepWidth'(events.dark),
    StepWidth'(frame_dropped), StepWidth'(events.frame_out), StepWidth'(events.frame_in)
  };

  always_ff @(posedge clk) begin
    for (int n = 0; n < Counters; n++) begin
      counts[32*n+:32] <= counted(counts[32*n+:32], more[StepWidth*n+:StepWidth], counters_cleared);
    end
    if (rst) counts <= '0;
  end

  // Of flipped bits there are few.

  logic [7:0] flips, residuals;
  always_ff @(posedge clk) begin
    flips <= counters_cleared ? 8'(events.flipped) : flips + 8'(events.flipped & (flips != '1));
    residuals <= counters_cleared ? 8'(events.residual) : residuals + 8'(events.residual & (residuals != '1));
    if (rst) {flips, residuals} <= '0;
  end

  // The largest residual follows a cycle later, as its comparison is long.

  logic record_q, cleared_q;
  logic [31:0] largest, residual_q;
  always_ff @(posedge clk) begin
    record_q <= events.record_valid;
    cleared_q <= counters_cleared;
    residual_q <= levels.residual;
    if (record_q && (cleared_q || residual_q > largest)) largest <= residual_q;
    else if (cleared_q) largest <= '0;
    if (rst) {largest, record_q, cleared_q} <= '0;
  end

  logic [31:0] frames_in, frames_out, frames_dropped, dark_pixels, depth_dropped, records_lost, saturations;
  logic [31:0] arrived, self_test;
  assign self_test = levels.self_test;
  assign arrived = (32'(levels.arrived_columns) << ArrivedColumnsLsb) | (32'(levels.arrived_rows) << ArrivedRowsLsb);
  assign {saturations, records_lost, depth_dropped, dark_pixels, frames_dropped, frames_out, frames_in} = counts;
  always_comb begin
    case (read_offset)
      StatusOffset: read_data = status_shown;
      InterruptStatusOffset: read_data = interrupts;
      FirstDepthLatencyOffset: read_data = latency;
      FramesInOffset: read_data = frames_in;
      FramesOutOffset: read_data = frames_out;
      FramesDroppedOffset: read_data = frames_dropped;
      SaturationsOffset: read_data = saturations;
      DarkPixelsOffset: read_data = dark_pixels;
      DepthDroppedOffset: read_data = depth_dropped;
      RecordsLostOffset: read_data = records_lost;
      FlipsOffset: read_data = 32'(flips);
      ResidualsOffset: read_data = 32'(residuals);
      LargestResidualOffset: read_data = largest;
      ArrivedOffset: read_data = arrived;
      SelfTestOffset: read_data = self_test;
      default: read_data = '0;
    endcase
  end

endmodule

`default_nettype wire
