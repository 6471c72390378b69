// SPDX-License-Identifier: Apache-2.0
// table_banks: decides which of its two banks each table uses, and starts captures into the bank that is not in use.
//
// A 1 written to TABLE_COMMIT, or `done` of a capture, requests that a table change over to its other bank:
// docs/streams.md, Tables. table_bank changes with the next frame_start, in that cycle; table_in_use says which bank
// the table uses, and comes from afar, so it counts a cycle later. A table is `closed`, to writes and to commits, while
// its change-over is pending or it is captured. A capture's request is high in the cycle of the write that starts it,
// but not in a reset; from the next cycle to that of `done`, `busy` shall be high. A start is refused for a table that
// the build has not, and for the zero offset while its change-over is pending. rst forgets what no frame has taken and
// leaves the banks; cold_rst, together with rst, clears them.
// Model: models/tactile_depth/chip/registers/table_banks.py.

`default_nettype none

module table_banks
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter int Present = 15  // bit n: the build has table n of TABLE_SELECT
) (
  input  wire                   clk,
  input  wire                   rst,
  input  wire                   cold_rst,
  input  wire                   write,
  input  wire  [31:0]           write_offset,
  input  wire  [31:0]           write_ones,  // the data, 0 in bytes without strobe
  output logic                  write_refused,
  input  wire  [31:0]           read_offset,
  output logic [31:0]           read_data,   // the word at read_offset, 0 where there is none

  input  wire                   frame_start,  // the first pixel of a frame passes the head of the pipeline
  output logic [3:0]            table_bank,
  input  wire  [3:0]            table_in_use,
  output logic [3:0]            closed,
  output logic                  reference_request,
  input  wire  capture_status_t reference_status,
  output logic                  zero_request,
  input  wire  capture_status_t zero_status
);

  localparam logic [3:0] Has = 4'(Present);

  logic [3:0] requested;    // a change-over that no frame has taken
  logic [3:0] bank = '0;    // no reset: it says where the tables are, which no reset touches
  logic [3:0] in_use = '0;  // no reset: as the banks
  logic [3:0] pending, commits, captured;
  logic starts, starts_reference, starts_zero, no_reference, no_zero;

  assign starts = frame_start && !rst;
  assign table_bank = bank ^ (requested & {4{starts}});
  assign pending = requested | ((bank ^ in_use) & Has);
  assign captured =
    (4'(reference_status.done) << TableCommitReferenceBit) | (4'(zero_status.done) << TableCommitZeroBit);
  assign closed = pending
    | (4'(reference_status.busy) << TableCommitReferenceBit) | (4'(zero_status.busy) << TableCommitZeroBit);
  assign commits = write && write_offset == TableCommitOffset ? write_ones[3:0] & ~closed : '0;

  assign starts_reference = write_offset == ReferenceCaptureOffset && write_ones[ReferenceCaptureStartBit];
  assign starts_zero = write_offset == ZeroCaptureOffset && write_ones[ZeroCaptureStartBit];
  assign no_reference = !Has[TableCommitReferenceBit];
  assign no_zero = !Has[TableCommitZeroBit] || pending[TableCommitZeroBit] || zero_status.done;
  assign write_refused = (starts_reference && no_reference) || (starts_zero && no_zero);
  assign reference_request = write && starts_reference && !no_reference && !rst;
  assign zero_request = write && starts_zero && !no_zero && !rst;

  always_ff @(posedge clk) begin
    requested <= (requested & {4{!frame_start}}) | ((commits | captured) & Has);
    if (starts) bank <= table_bank;
    in_use <= table_in_use;
    if (rst) requested <= '0;
    if (cold_rst) bank <= '0;
  end

  assign read_data = read_offset == TableCommitOffset ? 32'(pending)
    : read_offset == ReferenceCaptureOffset ? 32'(reference_status.busy) << ReferenceCaptureBusyBit
    : read_offset == ZeroCaptureOffset ? 32'(zero_status.busy) << ZeroCaptureBusyBit : '0;

endmodule

`default_nettype wire
