// SPDX-License-Identifier: Apache-2.0
// fv_table_signatures: a bank becomes known by a run of its words alone, in order and with nothing between, and its
// signature is that of the run; any other write of the bank makes it unknown. Held is what a capture wrote last.
//
// One arbitrary bank of one arbitrary table is followed. Of a capture it is assumed that it has no word without a step,
// and ends with a step. A signature at power-up, and several zero offsets in a step, are left to simulation.

parameter int Side = 1;
input logic [1:0] pick;
input logic pick_bank;

assign allowed = (reference_captured.steps || {reference_captured.ends, reference_captured.word} == '0)
  && (zero_captured.steps || {zero_captured.ends, zero_captured.word} == '0);

logic [1:0] pick_was;
logic pick_bank_was;
always_comb if (started) assume (pick == pick_was && pick_bank == pick_bank_was);

// An access of the host, a clock late: a word in order, or one that is not.
logic is_gradient, high, low, whole, moves, in_order, wrong, host_starts, half;
table_command_t bus;
assign is_gradient = 32'(bus.select) == TableSelectGradient;
assign low = bus.write;
assign in_order = low ? half == is_gradient : high && is_gradient && !half && whole;
assign wrong = ((low || (high && is_gradient)) && !in_order) || bus.read || moves;
assign host_starts = in_order && !half && bus.index == '0 && !rst;
always_ff @(posedge clk) begin
  bus <= table_command;
  high <= write && write_offset == TableHighOffset && !rst;
  moves <= write && write_offset == TableIndexOffset && !rst;
  whole <= write_mask == '1;
  if (rst) {bus.write, bus.read} <= '0;
end

// The captures: of the followed table, and of the other one.
logic is_reference, is_zero, starts, starts_any, steps, steps_other, ends, free, changed, captures;
captured_t own;
assign is_reference = 32'(pick) == TableSelectReference;
assign is_zero = 32'(pick) == TableSelectZero;
assign own = is_reference ? reference_captured : is_zero ? zero_captured : '0;
assign starts_any = host_starts || reference_captured.starts || zero_captured.starts;
assign starts = host_starts ? bus.select == pick
  : reference_captured.starts ? is_reference : zero_captured.starts && is_zero;

// A word of the host counts a clock after its write; the last one has brought the index back to 0.
logic host_step, host_low;
logic [1:0] host_table;
logic [31:0] host_word;
assign steps = (host_step && host_table == pick) || own.steps;
assign steps_other = (host_step && host_table != pick) || (reference_captured.steps && !is_reference)
  || (zero_captured.steps && !is_zero);
assign ends = (host_step && host_low && bus.index == '0) || reference_captured.ends || zero_captured.ends;
assign free = table_in_use[pick] != pick_bank;
assign captures = own.writes && free;
assign changed = captures || (low && bus.select == pick && free);

logic running = 1'b0, done = 1'b0, known = 1'b0, held = 1'b0;
logic shown, shown_known;
logic [31:0] signature;
always_ff @(posedge clk) begin
  pick_was <= pick;
  pick_bank_was <= pick_bank;
  if (high || low) half <= high && in_order;
  host_step <= in_order && !rst;
  host_low <= low;
  host_table <= bus.select;
  host_word <= bus.low;
  running <= starts_any ? starts && free : running && free && !wrong && !steps_other && !ends;
  done <= running && free && !wrong && !steps_other && ends && !starts_any && !rst;
  if (starts) signature <= '1;
  else if (steps) signature <= signature_step(signature, (host_step ? host_word : '0) | own.word);
  known <= (known || done) && !changed && !cold_rst;
  held <= (changed ? captures : held) && !cold_rst;
  if (!dut.finished) {shown, shown_known} <= {table_command.select == pick && !free, known};
  if (rst) {half, running} <= '0;
end

logic run_of_core;
assign run_of_core = dut.table_run == pick && dut.bank_run == pick_bank;
always_comb begin
  if (started) begin
    follows: assert (running == (dut.runs && run_of_core) && done == (dut.finished && run_of_core));
    if (running || done) sum: assert (dut.signature == signature);
    knows: assert (dut.known[{pick, pick_bank}] == known && dut.held[{pick, pick_bank}] == held);
    if (read_offset == TableSignatureOffset) begin
      if (shown) signature_reads: assert (read_data == (shown_known ? dut.signature_in_use : '0));
    end else if (read_offset == ReferenceCaptureOffset) begin
      if (is_reference && !free) reference_reads: assert (read_data == 32'(held) << ReferenceCaptureHeldBit);
    end else if (read_offset == ZeroCaptureOffset) begin
      if (is_zero && !free) zero_reads: assert (read_data == 32'(held) << ZeroCaptureHeldBit);
    end else nothing_else: assert (read_data == '0);

    becomes_known: cover (known && !held && shown_known && shown);
    two_words: cover (done && 32'(pick) == TableSelectGradient);
    of_a_capture: cover (known && held && !free);
    lost: cover (known && changed);
  end
end
