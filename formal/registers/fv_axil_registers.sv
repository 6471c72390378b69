// SPDX-License-Identifier: Apache-2.0
// fv_axil_registers: the rules of AXI4-Lite, and every register as docs/generated/registers.md has it, at the widths in
// use.
//
// Nothing is assumed of the master, the pipeline, the tables or reset; the registers of the camera answer at their
// offsets alone. The registers of the specification change by what was seen on the ports alone; what table_signatures
// answers is proven of itself.

parameter int Polynomial = 0, Corrections = 0, Camera = 0, DepthMantissa = 24'hABCDEF, DepthExponent = -41,
    SlopeMantissa = 24'h812345, SlopeExponent = 3, PitchNm = 63400, ResidualBound = 1234567;
localparam logic [ConfigBits-1:0] Config = configuration();

assign allowed = 1'b1;

localparam int GradientWords = Polynomial != 0 && Corrections == 0 ? 0 : 1 << 3 * BitsPerChannel,
    CoefficientWords = Polynomial != 0 ? PolynomialWords : 0, ZeroWords = 4 * 8, ReferenceWords = 4 * ZeroWords,
    Tables = TableSelectSelectCount,
    IndexWidth = $clog2(GradientWords > ReferenceWords ? GradientWords : ReferenceWords);
localparam logic [1:0] Okay = 2'b00;
localparam logic [1:0] SlaveError = 2'b10;

function automatic logic [ConfigBits-1:0] configuration();
  configuration = DefaultConfig;
  configuration[32*TridiagonalField+:32] = 1;
  configuration[32*NeumannField+:32] = 1;
  configuration[32*RowsField+:32] = 8;
  configuration[32*ColumnsField+:32] = 16;
  configuration[32*DataWidthField+:32] = 24;
  configuration[32*GradientWidthField+:32] = 21;
  configuration[32*GradientFractionField+:32] = 20;
  configuration[32*BitsPerChannelField+:32] = 4;
  configuration[32*FlatFieldField+:32] = 1;
  configuration[32*PolynomialField+:32] = Polynomial;
  configuration[32*CorrectionsField+:32] = Corrections;
  configuration[32*LightGainsField+:32] = Polynomial;
  configuration[32*ZeroOffsetField+:32] = 1;
  configuration[32*BlockLog2Field+:32] = 1;
  configuration[32*DepthMantissaField+:32] = DepthMantissa;
  configuration[32*DepthExponentField+:32] = DepthExponent;
  configuration[32*SlopeMantissaField+:32] = SlopeMantissa;
  configuration[32*SlopeExponentField+:32] = SlopeExponent;
  configuration[32*PitchNmField+:32] = PitchNm;
  configuration[32*CameraField+:32] = Camera;
  configuration[32*ResidualBoundField+:32] = ResidualBound;
endfunction

// What the bus carried.
logic aw, w, b, ar, r;
assign aw = s_axil_awvalid & s_axil_awready;
assign w = s_axil_wvalid & s_axil_wready;
assign b = s_axil_bvalid & s_axil_bready;
assign ar = s_axil_arvalid & s_axil_arready;
assign r = s_axil_rvalid & s_axil_rready;
logic has_address, has_data, answered, asked, reads;  // of the write, of the read in flight; reads: asked a clock ago
logic [AddressWidth-1:0] address, read_address;
logic [31:0] data;
logic [3:0] strobes;

// Tables: the clocks since one was asked, for which word, whether it has such an entry; change-overs requested.
logic [2:0] since;
logic upper, has_entry;
int size;
logic [1:0] select;
logic [Tables-1:0] requested, has;
logic [Tables-1:0] bank = '0;
logic [3:0] waits, closed;  // to the bus: while waiting, reference and zero offset while they are captured too
logic [31:0] next_index;
logic [31:0] index;

// A table says late which bank it uses, and changes over to the bank asked for alone.
logic [3:0] in_use = '0;
always_ff @(posedge clk) in_use <= table_in_use;
always_comb if (started) assume (((table_in_use ^ in_use) & (table_in_use ^ bank)) == '0);

always_comb begin
  size = select == TableSelectGradient ? GradientWords : select == TableSelectCoefficients ? CoefficientWords
      : select == TableSelectReference ? ReferenceWords : ZeroWords;
  has = '0;
  has[TableCommitGradientBit] = GradientWords != 0;
  has[TableCommitCoefficientsBit] = CoefficientWords != 0;
  has[TableCommitReferenceBit] = ReferenceWords != 0;
  has[TableCommitZeroBit] = ZeroWords != 0;
  waits = 4'(requested | ((bank ^ in_use) & has));
  closed = waits;
  if (reference_status.busy) closed[TableCommitReferenceBit] = 1'b1;
  if (zero_status.busy) closed[TableCommitZeroBit] = 1'b1;
  next_index = index + 32'd1 == size ? '0 : 32'(IndexWidth'(index + 32'd1));
end

// Effect of a write, in the clock before its answer.
logic effective, refused, camera_writes, camera_reads;
int offset;
logic [31:0] mask;
assign effective = has_address & has_data & ~answered & ~reads & (since == 3'd0);
assign offset = 32'(address) / 4 * 4;
always_comb begin
  for (int bit_number = 0; bit_number < 32; bit_number++) mask[bit_number] = strobes[bit_number/8];
  refused = !(camera_writes || offset == ControlOffset || offset == StatusOffset || offset == ThresholdOffset
      || offset == TimeoutOffset || offset == TableSelectOffset || offset == TableIndexOffset
      || offset == TableHighOffset || offset == TableCommitOffset || offset == DarkLevelOffset
      || offset == InterruptStatusOffset || offset == InterruptMaskOffset || offset == PitchOffset
      || offset == OffThresholdOffset || offset == AreaThresholdOffset || offset == MinimumAreaOffset
      || offset == DebounceOffset
      || offset == SlopeLimitOffset || offset == LightOffset || offset == LightGainRedOffset || offset == LightGainGreenOffset
      || offset == LightGainBlueOffset
      || (offset == ReferenceCaptureOffset && (ReferenceWords != 0 || !(data[ReferenceCaptureStartBit] && strobes[ReferenceCaptureStartBit/8])))
      || (offset == ZeroCaptureOffset
          && (ZeroWords != 0 && !waits[TableCommitZeroBit] && !zero_status.done
              || !(data[ZeroCaptureStartBit] && strobes[ZeroCaptureStartBit/8])))
      || (offset == TableLowOffset && index < size && !closed[select] && strobes == 4'b1111));
end
function automatic logic writes(input int register_offset);
  return effective & (offset == register_offset);
endfunction
logic writes_low, writes_capture, writes_zero;
assign writes_low = writes(TableLowOffset) & ~refused;
assign writes_capture = writes(ReferenceCaptureOffset) & ~refused;
assign writes_zero = writes(ZeroCaptureOffset) & ~refused;

function automatic logic [31:0] written(input logic [31:0] word);
  return (data & mask) | (word & ~mask);
endfunction
function automatic logic [31:0] counted(input logic [31:0] count, input int more);
  logic [33:0] sum;
  sum = 34'(count) + 34'(more);
  return sum > 34'hffffffff ? 32'hffffffff : 32'(sum);
endfunction

logic hold, drop;
logic [31:0] light;
logic [2:0] writes_gain;
assign writes_gain = {writes(LightGainBlueOffset), writes(LightGainGreenOffset), writes(LightGainRedOffset)};
logic [LightGainWidth-1:0] gain_before;
assign gain_before = writes_gain[0] ? light_gains[0] : writes_gain[1] ? light_gains[1] : light_gains[2];
logic [31:0] dim, steepest, averaged, zero_averaged, off, level, area, frames_needed, dark, given_up, lost;
logic [31:0] limit, silence, high, frames_in, frames_out, frames_dropped, clipped, largest, latency;
logic [7:0] flips, residuals;  // 255 stands for more
logic clears, clears_q, record_q;  // of the clock before, with its residual
logic [31:0] residual_q;
wire [3:0][31:0] of_checks = {32'(ResidualBound), largest, 32'(residuals), 32'(flips)};  // at FLIPS and behind it
assign clears = writes(ControlOffset) & data[ControlClearCountersBit] & mask[ControlClearCountersBit];
// Events reach status and counters a clock later; those of a clock in reset do not.
events_t seen;
logic seen_frame_dropped;
always_ff @(posedge clk) seen <= rst ? '0 : events;
assign seen_frame_dropped = seen.faults != '0;
logic [31:0] sticky, happened, interrupts, interrupts_happened, unmasked, width_nm;
logic raised;
always_comb begin
  happened = '0;
  happened[StatusRowShortBit] = seen.faults.row_short;
  happened[StatusRowLongBit] = seen.faults.row_long;
  happened[StatusStartMissingBit] = seen.faults.start_missing;
  happened[StatusStartEarlyBit] = seen.faults.start_early;
  happened[StatusTimeoutBit] = seen.faults.timed_out;
  happened[StatusOutOfStepBit] = seen.out_of_step;
  happened[StatusSaturationBit] = seen.saturations != 0;
  happened[StatusDarkBit] = seen.dark;
  happened[StatusDepthDroppedBit] = seen.depth_dropped;
  happened[StatusFlippedBit] = seen.flipped;
  happened[StatusResidualBit] = seen.residual;
  interrupts_happened = '0;
  interrupts_happened[InterruptStatusRecordBit] = seen.record_valid;
  interrupts_happened[InterruptStatusFrameDroppedBit] = seen_frame_dropped;
  interrupts_happened[InterruptStatusFlippedBit] = seen.flipped;
  interrupts_happened[InterruptStatusResidualBit] = seen.residual;
end

// What a read of this clock shall return.
logic [31:0] word, word_q, now;
logic known, known_q;
int read_offset;
assign read_offset = 32'(read_address) / 4 * 4;
always_comb begin
  now = sticky;
  now[StatusBusyBit] = levels.busy;
  now[StatusContactBit] = levels.contact;
  now[StatusTouchingBit] = levels.touching;
  now[StatusHuntingBit] = levels.hunting;
  now[StatusStalledBit] = levels.stalled;
  known = 1'b1;
  word = '0;
  if (read_offset == IdOffset) word = IdReset;
  else if (read_offset == GridOffset) word = 32'(Columns * 65536 + Rows);
  else if (read_offset == FormatOffset) begin
    word = 32'((((GradientWords != 0 ? BitsPerChannel : 0) * 256 + GradientFraction) * 256 + GradientWidth) * 256 + DataWidth);
  end
  else if (read_offset == ControlOffset) begin
    word[ControlHoldContactBit] = hold;
    word[ControlDropFramesBit] = drop;
  end
  else if (read_offset == StatusOffset) word = now;
  else if (read_offset == ThresholdOffset) word = limit;
  else if (read_offset == TimeoutOffset) word = silence;
  else if (read_offset == FramesInOffset) word = frames_in;
  else if (read_offset == FramesOutOffset) word = frames_out;
  else if (read_offset == FramesDroppedOffset) word = frames_dropped;
  else if (read_offset == SaturationsOffset) word = clipped;
  else if (read_offset == FirstDepthLatencyOffset) word = latency;
  else if (read_offset == TableIndexOffset) word = index;
  else if (read_offset == TableSelectOffset) word = 32'(select);
  else if (read_offset == TableCommitOffset) word = 32'(waits);
  else if (read_offset == TableSizeOffset) word = size;
  else if (read_offset == DarkLevelOffset) word = dim;
  else if (read_offset == SlopeLimitOffset) word = steepest;
  else if (read_offset == ReferenceCaptureOffset) begin
    word = averaged;
    word[ReferenceCaptureBusyBit] = reference_status.busy;
    word[ReferenceCaptureHeldBit] = dut.signature_data[ReferenceCaptureHeldBit];
  end
  else if (read_offset == ZeroCaptureOffset) begin
    word = zero_averaged;
    word[ZeroCaptureBusyBit] = zero_status.busy;
    word[ZeroCaptureHeldBit] = dut.signature_data[ZeroCaptureHeldBit];
  end
  else if (read_offset == DarkPixelsOffset) word = dark;
  else if (read_offset == DepthDroppedOffset) word = given_up;
  else if (read_offset == RecordsLostOffset) word = lost;
  else if (read_offset >= FlipsOffset && read_offset <= ResidualBoundOffset) word = of_checks[read_offset[3:2] ^ 2'd2];
  else if (read_offset == ArrivedOffset) word = {16'(levels.arrived_columns), 16'(levels.arrived_rows)};
  else if (read_offset == SelfTestOffset) word = levels.self_test;
  else if (read_offset == OffThresholdOffset) word = off;
  else if (read_offset == AreaThresholdOffset) word = level;
  else if (read_offset == MinimumAreaOffset) word = area;
  else if (read_offset == DebounceOffset) word = frames_needed;
  else if (read_offset == InterruptStatusOffset) word = interrupts;
  else if (read_offset == InterruptMaskOffset) word = unmasked;
  else if (read_offset == DeviceOffset) word = 32'h0100011b | 32'(Polynomial * 36) | (value(DefaultConfig, GainWidthField) << DeviceGainWidthLsb);
  else if (read_offset == TableSignatureOffset) word = dut.signature_data;
  else if (read_offset == ArithmeticOffset) word = arithmetic(Config);
  else if (read_offset == DepthUnitOffset) word = {8'(DepthExponent), 24'(DepthMantissa)};
  else if (read_offset == SlopeUnitOffset) word = {8'(SlopeExponent), 24'(SlopeMantissa)};
  else if (read_offset == PitchOffset) word = width_nm;
  else if (read_offset == LightOffset) word = light;
  else if (read_offset == LightGainRedOffset) word = Polynomial != 0 ? 32'(light_gains[0]) : '0;
  else if (read_offset == LightGainGreenOffset) word = Polynomial != 0 ? 32'(light_gains[1]) : '0;
  else if (read_offset == LightGainBlueOffset) word = Polynomial != 0 ? 32'(light_gains[2]) : '0;
  else if (read_offset >= RecordEventOffset && read_offset <= RecordCentroidOffset) begin
    word = 32'(record >> 8 * (read_offset - RecordEventOffset));
  end
  else if (read_offset == RecordFlagsOffset) word = record[12*32+:32];
  else if (read_offset == RecordLightOffset) word = record[13*32+:32];
  else if (read_offset == RecordPixelsOffset) word = record[14*32+:32];
  else begin
    known = camera_reads;
    word = camera_reads ? register_answer.data : '0;
  end
end
logic [31:0] held;
assign held = 32'(read_offset == ReferenceCaptureOffset) << ReferenceCaptureHeldBit
  | 32'(read_offset == ZeroCaptureOffset) << ZeroCaptureHeldBit;
assign camera_writes = Camera != 0 && register_answer.writable;
assign camera_reads = Camera != 0 && register_answer.readable;
always_comb begin
  if (read_offset != TableSignatureOffset) assume ((dut.signature_data & ~held) == '0);
  if (register_answer.writable) assume (register_command.write_offset >> 6 == 32'd4);
  if (register_answer.readable) assume (register_command.read_offset >> 6 == 32'd4);
  else assume (register_answer.data == '0);
end

logic b_stalled, r_stalled, refused_q, write_due, read_due;
logic [1:0] bresp_q, rresp_q;
logic [31:0] rdata_q;
logic asks;  // a table
logic had_entry, had_known;  // a clock ago
assign asks = reads & (read_offset == TableHighOffset || read_offset == TableLowOffset);
logic [31:0] index_written, select_written;
assign index_written = written(index);
assign select_written = written(32'(select));
always_ff @(posedge clk) begin
  if (aw) address <= s_axil_awaddr;
  if (ar) read_address <= s_axil_araddr;
  reads <= ar;
  if (w) {data, strobes} <= {s_axil_wdata, s_axil_wstrb};
  has_address <= aw | (has_address & ~b);
  has_data <= w | (has_data & ~b);
  answered <= effective | (answered & ~b);
  asked <= ar | (asked & ~r);
  write_due <= effective;
  refused_q <= refused;
  read_due <= (reads & ~asks) | (since == 3'd4);
  word_q <= since == 3'd0 ? word : !has_entry ? '0 : upper ? table_answer.high : table_answer.low;
  known_q <= since == 3'd0 ? known : has_entry;
  if (asks) begin
    since <= 3'd1;
    upper <= read_offset == TableHighOffset;
  end else if (since != 3'd0) begin
    since <= since == 3'd4 ? 3'd0 : since + 3'd1;
  end
  if (since == 3'd1) has_entry <= index < size;
  had_entry <= index < size;
  had_known <= started;
  b_stalled <= s_axil_bvalid & ~s_axil_bready;
  r_stalled <= s_axil_rvalid & ~s_axil_rready;
  bresp_q <= s_axil_bresp;
  rresp_q <= s_axil_rresp;
  rdata_q <= s_axil_rdata;

  if (writes(ControlOffset) && mask[ControlHoldContactBit]) hold <= data[ControlHoldContactBit];
  if (writes(ControlOffset) && mask[ControlDropFramesBit]) drop <= data[ControlDropFramesBit];
  if (writes(DarkLevelOffset)) dim <= written(dim) & 32'hff;
  if (writes(SlopeLimitOffset)) steepest <= written(steepest) & 32'hff;
  if (writes_capture) averaged <= written(averaged) & 32'hf;
  if (writes_zero) zero_averaged <= written(zero_averaged) & 32'hf;
  if (writes(OffThresholdOffset)) off <= written(off);
  if (writes(AreaThresholdOffset)) level <= written(level);
  if (writes(MinimumAreaOffset)) area <= written(area);
  if (writes(DebounceOffset)) frames_needed <= written(frames_needed) & 32'hff;
  if (writes(ThresholdOffset)) limit <= written(limit);
  if (writes(TimeoutOffset)) silence <= written(silence);
  if (writes(TableIndexOffset)) index <= 32'(index_written[IndexWidth-1:0]);
  if (writes_low || (since == 3'd1 && !upper && index < size)) index <= next_index;
  if (writes(TableSelectOffset)) select <= select_written[1:0];
  if (writes(TableHighOffset)) high <= written(high);
  for (int table_number = 0; table_number < Tables; table_number++) begin
    if (frame_start && requested[table_number] && !rst) bank[table_number] <= !bank[table_number];
    if (frame_start && requested[table_number]) requested[table_number] <= 1'b0;
    else if (writes(TableCommitOffset) && data[table_number] && mask[table_number] && has[table_number]
        && !closed[table_number])
      requested[table_number] <= 1'b1;
    if (reference_status.done && table_number == TableSelectReference && has[table_number]) requested[table_number] <= 1'b1;
    if (zero_status.done && table_number == TableSelectZero && has[table_number]) requested[table_number] <= 1'b1;
  end
  interrupts <= (interrupts & ~(writes(InterruptStatusOffset) ? data & mask : '0)) | interrupts_happened;
  if (writes(InterruptMaskOffset)) unmasked <= written(unmasked) & 32'hf;
  if (writes(PitchOffset)) width_nm <= written(width_nm);
  if (writes(LightOffset)) light <= written(light) & 32'h71;
  raised <= |(interrupts & unmasked);
  sticky <= (sticky & ~(writes(StatusOffset) ? data & mask : '0)) | happened;
  frames_in <= counted(clears ? '0 : frames_in, 32'(seen.frame_in));
  frames_out <= counted(clears ? '0 : frames_out, 32'(seen.frame_out));
  frames_dropped <= counted(clears ? '0 : frames_dropped, 32'(seen_frame_dropped));
  clipped <= counted(clears ? '0 : clipped, 32'(seen.saturations));
  dark <= counted(clears ? '0 : dark, 32'(seen.dark));
  given_up <= counted(clears ? '0 : given_up, 32'(seen.depth_dropped));
  flips <= (clears ? '0 : flips) + 8'(seen.flipped && (clears || ~flips != '0));
  residuals <= (clears ? '0 : residuals) + 8'(seen.residual && (clears || ~residuals != '0));
  if (clears_q) largest <= '0;
  if (record_q && (clears_q || residual_q > largest)) largest <= residual_q;
  clears_q <= clears;
  record_q <= seen.record_valid;
  residual_q <= levels.residual;
  lost <= counted(clears ? '0 : lost, 32'(seen.record_lost));
  if (first_depth_latency_valid) latency <= first_depth_latency;

  if (rst) begin
    {has_address, has_data, answered, asked, reads, since, write_due, read_due, b_stalled, r_stalled, hold} <= '0;
    limit <= 32'h7fffffff;
    off <= 32'h7fffffff;
    level <= '0;
    area <= 32'd1;
    frames_needed <= 32'd1;
    {drop, dim, averaged, zero_averaged, dark, given_up, lost} <= '0;
    requested <= '0;
    {interrupts, unmasked, raised} <= '0;
    width_nm <= PitchNm;
    light <= 32'd1;
    steepest <= 32'hff;
    {silence, index, select, high, sticky, frames_in, frames_out, frames_dropped, clipped, flips, residuals, largest, latency,
      clears_q, record_q} <= '0;
  end
  if (cold_rst) bank <= '0;
end

always_comb begin
  never_in_reset: assert (!((table_command.write || table_command.read || reference_command.request
      || zero_command.request) && rst));
  if (started) begin
    // The bus.
    one_write_in_flight: assert (s_axil_awready == (!has_address && !rst) && s_axil_wready == (!has_data && !rst));
    one_read_in_flight: assert (s_axil_arready == (!asked && !rst));
    // Once each, never without a request.
    answered_when_due: assert (s_axil_bvalid == answered && s_axil_rvalid == (asked && !reads && since == 3'd0));
    if (write_due) write_response: assert (s_axil_bvalid && s_axil_bresp == (refused_q ? SlaveError : Okay));
    if (b_stalled) write_response_stable: assert (s_axil_bvalid && s_axil_bresp == bresp_q);
    if (read_due) begin
      read_response: assert (s_axil_rvalid && s_axil_rdata == word_q
          && s_axil_rresp == (known_q ? Okay : SlaveError));
    end
    if (r_stalled) read_stable: assert (s_axil_rvalid && s_axil_rdata == rdata_q && s_axil_rresp == rresp_q);
    // What leaves for the camera.
    camera_write: assert (register_command.write == (effective && !rst) && (!effective
        || register_command.write_offset == offset && register_command.write_mask == mask
        && register_command.write_ones == (data & mask)));
    if (reads) camera_read: assert (register_command.read_offset == read_offset);
    // What leaves for the pipeline.
    outputs: assert (contact_settings.threshold == limit && timeout == silence
        && contact_settings.hold_contact == hold);
    contact_words: assert (contact_settings.off_threshold == off && contact_settings.area_threshold == level
        && contact_settings.minimum_area == area && 32'(contact_settings.debounce) == frames_needed);
    stream_settings: assert (contact_settings.drop_frames == drop && 32'(dark_level) == dim && 32'(slope_limit) == steepest
        && 32'(reference_command.log2_frames) == averaged && 32'(zero_command.log2_frames) == zero_averaged);
    interrupt: assert (irq == raised);
    tests_itself: assert (self_test == (writes(ControlOffset) && data[ControlSelfTestBit] && mask[ControlSelfTestBit]
        && !rst));
    light_setting: assert (light_command.follow == light[0] && light_command.rate == light[6:4]);
    light_written: assert (light_command.write == (rst ? '0 : writes_gain)
        && (light_command.write == '0 || light_command.gain == 16'(written(32'(gain_before)))));
    captures: assert (reference_command.request
        == (writes_capture && data[ReferenceCaptureStartBit] && mask[ReferenceCaptureStartBit] && !rst));
    zero_captures: assert (zero_command.request
        == (writes_zero && data[ZeroCaptureStartBit] && mask[ZeroCaptureStartBit] && !rst));
    // Tables.
    table_written: assert (table_command.write == (writes_low && !rst));
    table_asked: assert (table_command.read == (since == 3'd1 && index < size && !rst));
    table_word: assert (table_command.select == select && 32'(table_command.index) == index
        && table_command.high == high);
    if (table_command.write) table_data: assert (table_command.low == data && index < size);
    if (had_known) of_the_clock_before: assert (dut.u_access.has_entry == had_entry);
    never_both: assert (!(table_command.write && since != 3'd0));
    banks: assert (table_bank == ((frame_start && !rst) ? bank ^ requested : bank));
    if (table_command.write) only_settled: assert (table_bank[select] == table_in_use[select]);
    if (table_command.write) not_captured: assert (!(reference_status.busy && select == TableSelectReference)
        && !(zero_status.busy && select == TableSelectZero));
    absent: assert ((table_bank & ~has) == '0);

    read_back: cover (read_due && read_offset == ThresholdOffset && word_q == 32'h12345678 && known_q);
    interrupted: cover (irq && interrupts == 32'h2);
    set_wins: cover (writes(StatusOffset) && data[StatusRowLongBit] && mask[StatusRowLongBit] && seen.faults.row_long
        && sticky[StatusRowLongBit]);
    refused_while_pending: cover (effective && offset == TableLowOffset && strobes == 4'b1111 && requested[TableCommitZeroBit]);
    if (Camera != 0) camera_answer: cover (read_due && known_q && word_q == 32'h12345678 && rdata_q == '0);
    if (Camera != 0) camera_written: cover (write_due && !refused_q && offset == 32'h104);
    refused_outside: cover (effective && offset == TableLowOffset && index == size && size == ZeroWords && refused);
    captured: cover (frame_start && requested == 4'b1100 && reference_status.busy && !zero_status.busy);
    reads_centroid: cover (read_due && read_offset == RecordCentroidOffset && word_q == 32'h12345678 && known_q);
    changes_over: cover (frame_start && requested == has);
    last_entry: cover (table_command.read && !upper && index == 31 && size == ZeroWords);
    second_bin: cover (table_command.write && table_command.index == 24'd1);
    data_first: cover (has_data && !has_address && aw);
    cleared: cover (clears && frames_in != 0 && seen.frame_in);
  end
end
