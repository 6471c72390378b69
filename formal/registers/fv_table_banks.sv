// SPDX-License-Identifier: Apache-2.0
// fv_table_banks: a table's bank changes with a frame alone, and only after a commit or a capture asked for it.
//
// One arbitrary table is followed: `pick` is free and constant. Nothing is assumed of writes, frames, tables or resets.

parameter int Present = 15;
input logic [1:0] pick;

assign allowed = 1'b1;

logic [1:0] pick_was;
always_comb if (started) assume (pick == pick_was);

// The followed table: a request that no frame has taken, its bank, and its capture.
logic has, requested, bank, in_use, waits, busy, done, commits, is_reference, is_zero, shown;
assign has = Present[pick];
assign is_reference = 32'(pick) == TableSelectReference;
assign is_zero = 32'(pick) == TableSelectZero;
assign busy = (is_reference && reference_status.busy) || (is_zero && zero_status.busy);
assign done = (is_reference && reference_status.done) || (is_zero && zero_status.done);
assign waits = requested || (has && bank != in_use);
assign commits = write && write_offset == TableCommitOffset && write_ones[pick] && has && !waits && !busy;
assign shown = table_bank[pick];
logic asks, may_start;
assign asks = (is_reference && write_offset == ReferenceCaptureOffset && write_ones[ReferenceCaptureStartBit])
  || (is_zero && write_offset == ZeroCaptureOffset && write_ones[ZeroCaptureStartBit]);
assign may_start = has && !(is_zero && (waits || done));

always_ff @(posedge clk) begin
  pick_was <= pick;
  in_use <= table_in_use[pick];
  if (frame_start && !rst && requested) bank <= !bank;
  if (frame_start) requested <= 1'b0;
  if (commits || (done && has)) requested <= 1'b1;
  if (rst) requested <= 1'b0;
  if (cold_rst) bank <= 1'b0;
  if (!started) bank <= cold_rst ? 1'b0 : shown;  // of the power-up
end

always_comb begin
  if (started) begin
    bank_of_the_frame: assert (shown == (bank ^ (requested && frame_start && !rst)));
    closed_while_it_waits: assert (closed[pick] == (waits || busy));
    if (read_offset == TableCommitOffset) commit_reads: assert (read_data[pick] == waits && read_data[31:4] == '0);
    if (read_offset == ReferenceCaptureOffset) reference_reads: assert (read_data == 32'(reference_status.busy) << ReferenceCaptureBusyBit);
    if (read_offset == ZeroCaptureOffset) zero_reads: assert (read_data == 32'(zero_status.busy) << ZeroCaptureBusyBit);
    if (asks) refused_or_not: assert (write_refused == !may_start);
    if (write_offset != ReferenceCaptureOffset && write_offset != ZeroCaptureOffset) no_other: assert (!write_refused);
    if (is_reference) reference_asked: assert (reference_request == (write && asks && may_start && !rst));
    if (is_zero) zero_asked: assert (zero_request == (write && asks && may_start && !rst));

    changes_over: cover (frame_start && requested && has && bank);
    after_a_capture: cover (frame_start && requested && is_zero && !rst);
    cold: cover (cold_rst && bank && started);
  end
end
