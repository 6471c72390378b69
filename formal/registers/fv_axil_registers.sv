// SPDX-License-Identifier: Apache-2.0
// fv_axil_registers: the rules of AXI4-Lite, and every register as docs/registers.md has it, at the widths in use.
//
// Nothing is assumed of the master, the pipeline, the tables or reset. The registers of the specification change by
// what
// was seen on the ports alone.

module fv_axil_registers
  import register_map_pkg::*;
#(
  parameter int Rows             = 8,
  parameter int Columns          = 16,
  parameter int DataWidth        = 24,
  parameter int GradientWidth    = 21,
  parameter int GradientFraction = 20,
  parameter int BitsPerChannel   = 4,
  parameter int CoefficientWords = 36,
  parameter int ReferenceWords   = 1024,
  parameter int FloorWords       = 256,
  localparam int RecordWords = (RecordCentroidOffset - RecordEventOffset) / 4 + 1,
  localparam int Tables = TableSelectSelectCount,
  localparam int SelectWidth = TableSelectSelectWidth,
  localparam int IndexWidth = 3 * BitsPerChannel
) (
  input logic                    clk,
  input logic                    rst,
  input logic [AddressWidth-1:0] s_axil_awaddr,
  input logic                    s_axil_awvalid,
  input logic [31:0]             s_axil_wdata,
  input logic [3:0]              s_axil_wstrb,
  input logic                    s_axil_wvalid,
  input logic                    s_axil_bready,
  input logic [AddressWidth-1:0] s_axil_araddr,
  input logic                    s_axil_arvalid,
  input logic                    s_axil_rready,
  input logic                    event_row_short,
  input logic                    event_row_long,
  input logic                    event_start_missing,
  input logic                    event_start_early,
  input logic                    event_timeout,
  input logic                    event_out_of_step,
  input logic                    event_frame_in,
  input logic                    event_frame_out,
  input logic                    event_frame_dropped,
  input logic                    event_dark,
  input logic                    event_depth_dropped,
  input logic                    event_record_lost,
  input logic [7:0]              saturations,
  input logic [31:0]             first_depth_latency,
  input logic                    first_depth_latency_valid,
  input logic                    busy,
  input logic                    contact,
  input logic                    touching,
  input logic [32*RecordWords-1:0] record,
  input logic                    capture_busy,
  input logic                    capture_done,
  input logic                    floor_busy,
  input logic                    floor_done,
  input logic                    frame_start,
  input logic [31:0]             table_read_high,
  input logic [31:0]             table_read_low,
  input logic [Tables-1:0]       table_in_use
);

  localparam logic [1:0] Okay = 2'b00;
  localparam logic [1:0] SlaveError = 2'b10;

  logic s_axil_awready, s_axil_wready, s_axil_bvalid, s_axil_arready, s_axil_rvalid;
  logic [1:0] s_axil_bresp, s_axil_rresp;
  logic [31:0] s_axil_rdata, timeout;
  logic signed [31:0] threshold, off_threshold;
  logic [31:0] minimum_area;
  logic [7:0] debounce, dark_level;
  logic [3:0] capture_log2_frames, floor_log2_frames;
  logic hold_contact, drop_frames, capture_request, floor_request, table_write, table_read;
  logic [SelectWidth-1:0] table_select;
  logic [IndexWidth-1:0] table_index;
  logic [31:0] table_high, table_low;
  logic [Tables-1:0] table_bank;
  axil_registers #(
    .Rows(Rows), .Columns(Columns), .DataWidth(DataWidth), .GradientWidth(GradientWidth),
    .GradientFraction(GradientFraction), .BitsPerChannel(BitsPerChannel),
    .CoefficientWords(CoefficientWords), .ReferenceWords(ReferenceWords), .FloorWords(FloorWords)
  ) dut (.*);

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  // What the bus carried.
  logic aw, w, b, ar, r;
  assign aw = s_axil_awvalid & s_axil_awready;
  assign w = s_axil_wvalid & s_axil_wready;
  assign b = s_axil_bvalid & s_axil_bready;
  assign ar = s_axil_arvalid & s_axil_arready;
  assign r = s_axil_rvalid & s_axil_rready;
  logic has_address, has_data, answered, asked;  // of the write, of the read in flight
  logic [AddressWidth-1:0] address;
  logic [31:0] data;
  logic [3:0] strobes;

  // Tables: the clocks since one was asked, for which word, whether it has such an entry; change-overs requested.
  logic [2:0] since;
  logic upper, has_entry;
  int size;
  logic [1:0] select;
  logic [Tables-1:0] requested, has;
  logic [Tables-1:0] bank = '0;
  logic [3:0] waits, closed;  // to the bus: while waiting, reference and floor while they are captured too
  logic [31:0] next_index;
  logic [31:0] index;
  always_comb begin
    size = select == TableSelectGradient ? 1 << IndexWidth : select == TableSelectCoefficients ? CoefficientWords
        : select == TableSelectReference ? ReferenceWords : FloorWords;
    has = '0;
    has[TableCommitGradientBit] = 1'b1;
    has[TableCommitCoefficientsBit] = CoefficientWords != 0;
    has[TableCommitReferenceBit] = ReferenceWords != 0;
    has[TableCommitFloorBit] = FloorWords != 0;
    waits = 4'(requested | ((bank ^ table_in_use) & has));
    closed = waits;
    if (capture_busy) closed[TableCommitReferenceBit] = 1'b1;
    if (floor_busy) closed[TableCommitFloorBit] = 1'b1;
    next_index = index + 32'd1 == size ? '0 : 32'(IndexWidth'(index + 32'd1));
  end

  // Effect of a write, in the clock before its answer.
  logic effective, refused;
  int offset;
  logic [31:0] mask;
  assign effective = has_address & has_data & ~answered & (since == 3'd0);
  assign offset = 32'(address) / 4 * 4;
  always_comb begin
    for (int bit_number = 0; bit_number < 32; bit_number++) mask[bit_number] = strobes[bit_number/8];
    refused = !(offset == ControlOffset || offset == StatusOffset || offset == ThresholdOffset
        || offset == TimeoutOffset || offset == TableSelectOffset || offset == TableIndexOffset
        || offset == TableHighOffset || offset == TableCommitOffset || offset == DarkLevelOffset
        || offset == OffThresholdOffset || offset == MinimumAreaOffset || offset == DebounceOffset
        || (offset == CaptureOffset && (ReferenceWords != 0 || !(data[CaptureStartBit] && strobes[CaptureStartBit/8])))
        || (offset == FloorCaptureOffset
            && (FloorWords != 0 && !waits[TableCommitFloorBit] && !floor_done
                || !(data[FloorCaptureStartBit] && strobes[FloorCaptureStartBit/8])))
        || (offset == TableLowOffset && index < size && !closed[select] && strobes == 4'b1111));
  end
  logic writes_control, writes_status, writes_threshold, writes_timeout;
  logic writes_select, writes_index, writes_high, writes_low, writes_commit;
  logic writes_dark, writes_capture, writes_floor, writes_off, writes_area, writes_debounce;
  assign writes_control = effective & (offset == ControlOffset);
  assign writes_status = effective & (offset == StatusOffset);
  assign writes_threshold = effective & (offset == ThresholdOffset);
  assign writes_timeout = effective & (offset == TimeoutOffset);
  assign writes_index = effective & (offset == TableIndexOffset);
  assign writes_select = effective & (offset == TableSelectOffset);
  assign writes_high = effective & (offset == TableHighOffset);
  assign writes_low = effective & (offset == TableLowOffset) & ~refused;
  assign writes_commit = effective & (offset == TableCommitOffset);
  assign writes_dark = effective & (offset == DarkLevelOffset);
  assign writes_capture = effective & (offset == CaptureOffset) & ~refused;
  assign writes_floor = effective & (offset == FloorCaptureOffset) & ~refused;
  assign writes_off = effective & (offset == OffThresholdOffset);
  assign writes_area = effective & (offset == MinimumAreaOffset);
  assign writes_debounce = effective & (offset == DebounceOffset);

  function automatic logic [31:0] written(input logic [31:0] word);
    return (data & mask) | (word & ~mask);
  endfunction
  function automatic logic [31:0] counted(input logic [31:0] count, input int more);
    logic [33:0] sum;
    sum = 34'(count) + 34'(more);
    return sum > 34'hffffffff ? 32'hffffffff : 32'(sum);
  endfunction

  logic hold, drop;
  logic [31:0] dim, averaged, floor_averaged, off, area, frames_needed, dark, given_up, lost;
  logic [31:0] limit, silence, high, frames_in, frames_out, frames_dropped, clipped, latency;
  logic clears;
  assign clears = writes_control & data[ControlClearCountersBit] & mask[ControlClearCountersBit];
  logic [31:0] sticky, happened;
  always_comb begin
    happened = '0;
    happened[StatusRowShortBit] = event_row_short;
    happened[StatusRowLongBit] = event_row_long;
    happened[StatusStartMissingBit] = event_start_missing;
    happened[StatusStartEarlyBit] = event_start_early;
    happened[StatusTimeoutBit] = event_timeout;
    happened[StatusOutOfStepBit] = event_out_of_step;
    happened[StatusSaturationBit] = saturations != 0;
    happened[StatusDarkBit] = event_dark;
    happened[StatusDepthDroppedBit] = event_depth_dropped;
  end

  // What a read of this clock shall return.
  logic [31:0] word, word_q, now;
  logic known, known_q;
  int read_offset;
  assign read_offset = 32'(s_axil_araddr) / 4 * 4;
  always_comb begin
    now = sticky;
    now[StatusBusyBit] = busy;
    now[StatusContactBit] = contact;
    now[StatusTouchingBit] = touching;
    known = 1'b1;
    word = '0;
    if (read_offset == IdOffset) word = IdReset;
    else if (read_offset == GridOffset) word = 32'(Columns * 65536 + Rows);
    else if (read_offset == FormatOffset) begin
      word = 32'(((BitsPerChannel * 256 + GradientFraction) * 256 + GradientWidth) * 256 + DataWidth);
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
    else if (read_offset == CaptureOffset) begin
      word = averaged;
      word[CaptureBusyBit] = capture_busy;
    end
    else if (read_offset == FloorCaptureOffset) begin
      word = floor_averaged;
      word[FloorCaptureBusyBit] = floor_busy;
    end
    else if (read_offset == DarkPixelsOffset) word = dark;
    else if (read_offset == DepthDroppedOffset) word = given_up;
    else if (read_offset == RecordsLostOffset) word = lost;
    else if (read_offset == OffThresholdOffset) word = off;
    else if (read_offset == MinimumAreaOffset) word = area;
    else if (read_offset == DebounceOffset) word = frames_needed;
    else if (read_offset >= RecordEventOffset && read_offset <= RecordCentroidOffset) begin
      word = 32'(record >> 8 * (read_offset - RecordEventOffset));
    end
    else known = 1'b0;
  end

  logic b_stalled, r_stalled, refused_q, write_due, read_due;
  logic [1:0] bresp_q, rresp_q;
  logic [31:0] rdata_q;
  logic asks;  // a table
  assign asks = ar & (read_offset == TableHighOffset || read_offset == TableLowOffset);
  logic [31:0] index_written, select_written;
  assign index_written = written(index);
  assign select_written = written(32'(select));
  always_ff @(posedge clk) begin
    started <= 1'b1;
    if (aw) address <= s_axil_awaddr;
    if (w) {data, strobes} <= {s_axil_wdata, s_axil_wstrb};
    has_address <= aw | (has_address & ~b);
    has_data <= w | (has_data & ~b);
    answered <= effective | (answered & ~b);
    asked <= ar | (asked & ~r);
    write_due <= effective;
    refused_q <= refused;
    read_due <= (ar & ~asks) | (since == 3'd4);
    word_q <= since == 3'd0 ? word : !has_entry ? '0 : upper ? table_read_high : table_read_low;
    known_q <= since == 3'd0 ? known : has_entry;
    if (asks) begin
      since <= 3'd1;
      upper <= read_offset == TableHighOffset;
    end else if (since != 3'd0) begin
      since <= since == 3'd4 ? 3'd0 : since + 3'd1;
    end
    if (since == 3'd1) has_entry <= index < size;
    b_stalled <= s_axil_bvalid & ~s_axil_bready;
    r_stalled <= s_axil_rvalid & ~s_axil_rready;
    bresp_q <= s_axil_bresp;
    rresp_q <= s_axil_rresp;
    rdata_q <= s_axil_rdata;

    if (writes_control && mask[ControlHoldContactBit]) hold <= data[ControlHoldContactBit];
    if (writes_control && mask[ControlDropFramesBit]) drop <= data[ControlDropFramesBit];
    if (writes_dark) dim <= written(dim) & 32'hff;
    if (writes_capture) averaged <= written(averaged) & 32'hf;
    if (writes_floor) floor_averaged <= written(floor_averaged) & 32'hf;
    if (writes_off) off <= written(off);
    if (writes_area) area <= written(area);
    if (writes_debounce) frames_needed <= written(frames_needed) & 32'hff;
    if (writes_threshold) limit <= written(limit);
    if (writes_timeout) silence <= written(silence);
    if (writes_index) index <= 32'(index_written[IndexWidth-1:0]);
    if (writes_low || (since == 3'd1 && !upper && index < size)) index <= next_index;
    if (writes_select) select <= select_written[1:0];
    if (writes_high) high <= written(high);
    for (int table_number = 0; table_number < Tables; table_number++) begin
      if (frame_start && requested[table_number] && !rst) bank[table_number] <= !bank[table_number];
      if (frame_start && requested[table_number]) requested[table_number] <= 1'b0;
      else if (writes_commit && data[table_number] && mask[table_number] && has[table_number] && !closed[table_number])
        requested[table_number] <= 1'b1;
      if (capture_done && table_number == TableSelectReference && has[table_number]) requested[table_number] <= 1'b1;
      if (floor_done && table_number == TableSelectFloor && has[table_number]) requested[table_number] <= 1'b1;
    end
    sticky <= (sticky & ~(writes_status ? data & mask : '0)) | happened;
    frames_in <= counted(clears ? '0 : frames_in, 32'(event_frame_in));
    frames_out <= counted(clears ? '0 : frames_out, 32'(event_frame_out));
    frames_dropped <= counted(clears ? '0 : frames_dropped, 32'(event_frame_dropped));
    clipped <= counted(clears ? '0 : clipped, 32'(saturations));
    dark <= counted(clears ? '0 : dark, 32'(event_dark));
    given_up <= counted(clears ? '0 : given_up, 32'(event_depth_dropped));
    lost <= counted(clears ? '0 : lost, 32'(event_record_lost));
    if (first_depth_latency_valid) latency <= first_depth_latency;

    if (rst) begin
      {has_address, has_data, answered, asked, since, write_due, read_due, b_stalled, r_stalled, hold} <= '0;
      limit <= 32'h7fffffff;
      off <= 32'h7fffffff;
      area <= 32'd1;
      frames_needed <= 32'd1;
      {drop, dim, averaged, floor_averaged, dark, given_up, lost} <= '0;
      requested <= '0;
      {silence, index, select, high, sticky, frames_in, frames_out, frames_dropped, clipped, latency} <= '0;
    end
  end

  always_comb begin
    never_in_reset: assert (!((table_write || table_read || capture_request || floor_request) && rst));
    if (started) begin
      // The bus.
      one_write_in_flight: assert (s_axil_awready == !has_address && s_axil_wready == !has_data);
      one_read_in_flight: assert (s_axil_arready == !asked);
      // Once each, never without a request.
      answered_when_due: assert (s_axil_bvalid == answered && s_axil_rvalid == (asked && since == 3'd0));
      if (write_due) write_response: assert (s_axil_bvalid && s_axil_bresp == (refused_q ? SlaveError : Okay));
      if (b_stalled) write_response_stable: assert (s_axil_bvalid && s_axil_bresp == bresp_q);
      if (read_due) begin
        read_response: assert (s_axil_rvalid && s_axil_rdata == word_q
            && s_axil_rresp == (known_q ? Okay : SlaveError));
      end
      if (r_stalled) read_stable: assert (s_axil_rvalid && s_axil_rdata == rdata_q && s_axil_rresp == rresp_q);
      // What leaves for the pipeline.
      outputs: assert ($unsigned(threshold) == limit && timeout == silence && hold_contact == hold);
      contact_settings: assert ($unsigned(off_threshold) == off && minimum_area == area
          && 32'(debounce) == frames_needed);
      stream_settings: assert (drop_frames == drop && 32'(dark_level) == dim && 32'(capture_log2_frames) == averaged
          && 32'(floor_log2_frames) == floor_averaged);
      captures: assert (capture_request
          == (writes_capture && data[CaptureStartBit] && mask[CaptureStartBit] && !rst));
      floor_captures: assert (floor_request
          == (writes_floor && data[FloorCaptureStartBit] && mask[FloorCaptureStartBit] && !rst));
      // Tables.
      table_written: assert (table_write == (writes_low && !rst));
      table_asked: assert (table_read == (since == 3'd1 && index < size && !rst));
      table_word: assert (table_select == select && 32'(table_index) == index && table_high == high);
      if (table_write) table_data: assert (table_low == data && index < size);
      never_both: assert (!(table_write && since != 3'd0));
      banks: assert (table_bank == ((frame_start && !rst) ? bank ^ requested : bank));
      if (table_write) only_settled: assert (table_bank[select] == table_in_use[select]);
      if (table_write) not_captured: assert (!(capture_busy && select == TableSelectReference)
          && !(floor_busy && select == TableSelectFloor));
      absent: assert ((table_bank & ~has) == '0);

      read_back: cover (read_due && read_offset == ThresholdOffset && word_q == 32'h12345678 && known_q);
      set_wins: cover (writes_status && data[StatusRowLongBit] && mask[StatusRowLongBit] && event_row_long
          && sticky[StatusRowLongBit]);
      refused_while_pending: cover (effective && offset == TableLowOffset && strobes == 4'b1111 && requested[0]);
      refused_outside: cover (effective && offset == TableLowOffset && index == 36 && size == 36 && refused);
      captured: cover (frame_start && requested == 4'b1100 && capture_busy && !floor_busy);
      reads_centroid: cover (read_due && read_offset == RecordCentroidOffset && word_q == 32'h12345678 && known_q);
      changes_over: cover (frame_start && requested == 4'b0011);
      last_entry: cover (table_read && !upper && index == 35 && size == 36);
      second_bin: cover (table_write && table_index == IndexWidth'(1));
      data_first: cover (has_data && !has_address && aw);
      cleared: cover (clears && frames_in != 0 && event_frame_in);
    end
  end

endmodule
