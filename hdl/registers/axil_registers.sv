// SPDX-License-Identifier: Apache-2.0
// axil_registers: the registers of the pipeline, on AXI4-Lite.
//
// The map is docs/registers.md; the constants come from registers/tactile_depth.rdl. One write and one
// read in flight; no ready output depends on an input in the same clock. A write takes effect, and
// is answered, in the clock after both its address and its data were taken, whichever came first;
// a read is answered in the clock after its address was taken, with the registers as they were
// before. Responses wait for their ready, readies wait for the response before to be taken.
//
// Events are levels: each clock in which one is high counts once. What they set wins over what a
// write clears in the same clock.
//
// Tables, each held in two banks. table_write: the entry table_index of the bank not in use becomes
// {table_high, table_low}. table_read: its words are wanted, which shall stand on table_read_* from
// 3 clocks later until the next table_read; until then writes wait. Never both, nor one in reset,
// nor outside the table, nor a write while a change-over is pending. table_bank is the bank that
// each table shall use; it changes in a clock with frame_start alone, and is new in that clock. A
// core takes its bit over with the first pixel of its own next frame, or in reset, and shows the
// bank it uses on table_in_use: so all tables change over with the same frame, wherever they stand
// within a frame of the head of the pipeline.
//
// Capture of the reference table: capture_request is high in the clock in which its write takes effect. From the
// clock after it to that of capture_done, capture_busy shall be high: then the bus neither writes that table nor asks
// for its change-over. capture_done asks for that, as TABLE_COMMIT does. floor_*: the same for the floor, but that a
// start is refused while its change-over is pending: it comes so much later than a frame's start, that a capture would
// write the bank which is to be used. record: word n of the contact events in bits 32 n + 31 to 32 n; what is read is
// the word as it stands.
// Behavioural model: models/tactile_depth/registers/axil_registers.py.

module axil_registers
  import register_map_pkg::*;
#(
  parameter int Rows             = 128,
  parameter int Columns          = 128,
  parameter int DataWidth        = 24,
  parameter int GradientWidth    = 20,  // bits of a slope code, at most 32
  parameter int GradientFraction = 18,
  parameter int BitsPerChannel   = 4,   // 0: no gradient table
  parameter int CoefficientWords = 0,   // entries of these tables, 0: none
  parameter int ReferenceWords   = 0,
  parameter int FloorWords       = 0,
  localparam int RecordWords = (RecordCentroidOffset - RecordEventOffset) / 4 + 1,
  localparam int Tables = TableSelectSelectCount,
  localparam int SelectWidth = TableSelectSelectWidth,
  localparam int GradientWords = BitsPerChannel == 0 ? 0 : 1 << (3 * BitsPerChannel),
  localparam int SlopeWords = CoefficientWords > GradientWords ? CoefficientWords : GradientWords,
  localparam int MapWords = ReferenceWords > FloorWords ? ReferenceWords : FloorWords,
  localparam int IndexWidth = $clog2(SlopeWords > MapWords ? SlopeWords : MapWords)
) (
  input  logic                     clk,
  input  logic                     rst,

  input  logic [AddressWidth-1:0]  s_axil_awaddr,
  input  logic                     s_axil_awvalid,
  output logic                     s_axil_awready,
  input  logic [31:0]              s_axil_wdata,
  input  logic [3:0]               s_axil_wstrb,
  input  logic                     s_axil_wvalid,
  output logic                     s_axil_wready,
  output logic [1:0]               s_axil_bresp,
  output logic                     s_axil_bvalid,
  input  logic                     s_axil_bready,
  input  logic [AddressWidth-1:0]  s_axil_araddr,
  input  logic                     s_axil_arvalid,
  output logic                     s_axil_arready,
  output logic [31:0]              s_axil_rdata,
  output logic [1:0]               s_axil_rresp,
  output logic                     s_axil_rvalid,
  input  logic                     s_axil_rready,

  input  logic                     event_row_short,
  input  logic                     event_row_long,
  input  logic                     event_start_missing,
  input  logic                     event_start_early,
  input  logic                     event_timeout,
  input  logic                     event_out_of_step,
  input  logic                     event_frame_in,
  input  logic                     event_frame_out,
  input  logic                     event_frame_dropped,
  input  logic                     event_dark,
  input  logic                     event_depth_dropped,
  input  logic                     event_record_lost,
  input  logic [7:0]               saturations,  // values clipped in this clock
  input  logic [31:0]              first_depth_latency,
  input  logic                     first_depth_latency_valid,
  input  logic                     busy,
  input  logic                     contact,
  input  logic                     touching,
  input  logic [32*RecordWords-1:0] record,

  output logic signed [31:0]       threshold,
  output logic signed [31:0]       off_threshold,
  output logic [31:0]              minimum_area,
  output logic [7:0]               debounce,
  output logic [31:0]              timeout,
  output logic                     hold_contact,
  output logic                     drop_frames,
  output logic [7:0]               dark_level,

  output logic                     capture_request,
  output logic [3:0]               capture_log2_frames,
  input  logic                     capture_busy,
  input  logic                     capture_done,
  output logic                     floor_request,
  output logic [3:0]               floor_log2_frames,
  input  logic                     floor_busy,
  input  logic                     floor_done,

  input  logic                     frame_start,  // the first pixel of a frame passes the head
  output logic                     table_write,
  output logic                     table_read,
  output logic [SelectWidth-1:0]   table_select,
  output logic [IndexWidth-1:0]    table_index,
  output logic [31:0]              table_high,
  output logic [31:0]              table_low,
  input  logic [31:0]              table_read_high,  // of the table selected
  input  logic [31:0]              table_read_low,
  output logic [Tables-1:0]        table_bank,
  input  logic [Tables-1:0]        table_in_use
);

  localparam logic [1:0] Okay        = 2'b00;
  localparam logic [1:0] SlaveError  = 2'b10;
  localparam logic [31:0] AllOnes    = {32{1'b1}};
  localparam logic [31:0] GridWord   = (Rows << GridRowsLsb) | (Columns << GridColumnsLsb);
  localparam logic [31:0] FormatWord =
      (DataWidth << FormatDataWidthLsb)
    | (GradientWidth << FormatGradientWidthLsb)
    | (GradientFraction << FormatGradientFractionLsb)
    | (BitsPerChannel << FormatBitsPerChannelLsb);
  localparam logic [Tables-1:0] Present =
      (Tables'(GradientWords != 0) << TableCommitGradientBit)  // these are also the numbers in TABLE_SELECT
    | (Tables'(CoefficientWords != 0) << TableCommitCoefficientsBit)
    | (Tables'(ReferenceWords != 0) << TableCommitReferenceBit)
    | (Tables'(FloorWords != 0) << TableCommitFloorBit);

  logic aw_held = 1'b0;  // a clock before the first reset writes no table, which holds its contents from power-up
  logic w_held = 1'b0;
  logic [AddressWidth-1:0] write_address;
  logic [31:0] write_data;
  logic [3:0] write_strobe;

  logic [31:0] write_offset;
  logic [31:0] read_offset;
  logic [31:0] write_mask;
  logic [31:0] write_ones;  // what a write sets where a 1 clears or triggers
  logic write_refused;
  logic write_now;
  logic write_taken;
  logic asks_capture, asks_floor, floor_pending;
  logic [31:0] status_set;
  logic [31:0] status_cleared;
  logic counters_cleared;
  logic [Tables-1:0] commits;

  logic [3:0] reading;  // clocks since a table was asked
  logic read_is_low;
  logic read_inside;
  logic [31:0] table_size;
  logic [IndexWidth-1:0] table_last;
  logic inside_table;
  logic [Tables-1:0] requested;  // a change-over that no frame has taken
  logic [Tables-1:0] bank = '0;  // no reset: it says where the tables are, which no reset touches
  logic changes;
  logic [Tables-1:0] pending;
  logic [Tables-1:0] captured;
  logic [Tables-1:0] closed;  // to writes of the bus, and to commits
  logic [(1<<SelectWidth)-1:0] closed_of;

  logic [31:0] status;  // the sticky bits
  logic [31:0] frames_in;
  logic [31:0] frames_out;
  logic [31:0] frames_dropped;
  logic [31:0] saturations_count;
  logic [31:0] dark_pixels;
  logic [31:0] depth_dropped;
  logic [31:0] records_lost;
  logic [31:0] last_latency;

  // A register after this write: its bytes without strobe stay.
  function automatic logic [31:0] merged(input logic [31:0] word);
    merged = write_ones | (word & ~write_mask);
  endfunction

  // A counter that counts on, from 0 if it is cleared now, and stays at all ones.
  function automatic logic [31:0] counted(input logic [31:0] count, input logic [7:0] more);
    logic [32:0] sum;
    sum = {1'b0, counters_cleared ? 32'd0 : count} + 33'(more);
    counted = sum[32] ? AllOnes : sum[31:0];
  endfunction

  assign s_axil_awready = !aw_held;
  assign s_axil_wready = !w_held;
  assign s_axil_arready = !s_axil_rvalid && reading == '0;

  assign write_offset = 32'({write_address[AddressWidth-1:2], 2'b00});
  assign read_offset = 32'({s_axil_araddr[AddressWidth-1:2], 2'b00});
  assign write_mask = {
    {8{write_strobe[3]}}, {8{write_strobe[2]}}, {8{write_strobe[1]}}, {8{write_strobe[0]}}
  };
  assign write_ones = write_data & write_mask;
  assign write_now = aw_held && w_held && !s_axil_bvalid && reading == '0;
  assign write_taken = write_now && !write_refused;
  assign asks_floor = write_ones[FloorCaptureStartBit];
  assign asks_capture = write_ones[CaptureStartBit];  // Icarus 11 takes no select of a constant bit inside always_comb

  always_comb begin
    case (write_offset)
      ControlOffset, StatusOffset, ThresholdOffset, TimeoutOffset, TableSelectOffset, TableIndexOffset,
      TableHighOffset, TableCommitOffset, DarkLevelOffset, OffThresholdOffset, MinimumAreaOffset, DebounceOffset:
        write_refused = 1'b0;
      TableLowOffset:
        write_refused = !inside_table || write_strobe != 4'b1111 || closed_of[table_select];
      CaptureOffset: write_refused = asks_capture && ReferenceWords == 0;
      FloorCaptureOffset: write_refused = asks_floor && (FloorWords == 0 || floor_pending || floor_done);
      default: write_refused = 1'b1;
    endcase
  end

  assign status_set =
      (32'(event_row_short) << StatusRowShortBit)
    | (32'(event_row_long) << StatusRowLongBit)
    | (32'(event_start_missing) << StatusStartMissingBit)
    | (32'(event_start_early) << StatusStartEarlyBit)
    | (32'(event_timeout) << StatusTimeoutBit)
    | (32'(event_out_of_step) << StatusOutOfStepBit)
    | (32'(event_dark) << StatusDarkBit)
    | (32'(event_depth_dropped) << StatusDepthDroppedBit)
    | (32'(saturations != 8'd0) << StatusSaturationBit);
  assign status_cleared = (write_taken && write_offset == StatusOffset) ? write_ones : 32'd0;
  assign counters_cleared =
      write_taken && write_offset == ControlOffset && write_ones[ControlClearCountersBit];

  // The entry written or read is the one that stands in TABLE_INDEX, which moves on at the end of the clock.
  assign table_write = write_taken && write_offset == TableLowOffset && !rst;
  assign table_read = reading[0] && inside_table && !rst;
  assign table_low = write_data;
  assign inside_table = 32'(table_index) < table_size;
  assign table_last = IndexWidth'(table_size - 32'd1);
  always_comb begin
    case (32'(table_select))
      TableSelectGradient: table_size = GradientWords;
      TableSelectCoefficients: table_size = CoefficientWords;
      TableSelectReference: table_size = ReferenceWords;
      TableSelectFloor: table_size = FloorWords;
      default: table_size = 32'd0;
    endcase
  end

  assign changes = frame_start && !rst;
  assign table_bank = bank ^ (requested & {Tables{changes}});
  assign pending = requested | ((bank ^ table_in_use) & Present);
  assign floor_pending = pending[TableCommitFloorBit];
  assign captured =
      ((Tables'(capture_done) << TableCommitReferenceBit) | (Tables'(floor_done) << TableCommitFloorBit)) & Present;
  assign closed =
      pending | (Tables'(capture_busy) << TableCommitReferenceBit) | (Tables'(floor_busy) << TableCommitFloorBit);
  assign closed_of = (1 << SelectWidth)'(closed);
  assign commits = (write_taken && write_offset == TableCommitOffset) ? write_ones[Tables-1:0] : '0;
  assign capture_request = write_taken && write_offset == CaptureOffset && asks_capture && !rst;
  assign floor_request = write_taken && write_offset == FloorCaptureOffset && asks_floor && !rst;

  always_ff @(posedge clk) begin
    // Write channels.
    if (s_axil_awvalid && s_axil_awready) begin
      aw_held <= 1'b1;
      write_address <= s_axil_awaddr;
    end
    if (s_axil_wvalid && s_axil_wready) begin
      w_held <= 1'b1;
      write_data <= s_axil_wdata;
      write_strobe <= s_axil_wstrb;
    end
    if (write_now) begin
      s_axil_bvalid <= 1'b1;
      s_axil_bresp <= write_refused ? SlaveError : Okay;
    end
    if (s_axil_bvalid && s_axil_bready) begin
      s_axil_bvalid <= 1'b0;
      aw_held <= 1'b0;
      w_held <= 1'b0;
    end

    // Registers that are written.
    if (write_taken) begin
      case (write_offset)
        ControlOffset: begin
          if (write_mask[ControlHoldContactBit]) hold_contact <= write_data[ControlHoldContactBit];
          if (write_mask[ControlDropFramesBit]) drop_frames <= write_data[ControlDropFramesBit];
        end
        ThresholdOffset: threshold <= $signed(merged(threshold));
        TimeoutOffset: timeout <= merged(timeout);
        TableIndexOffset: table_index <= IndexWidth'(merged(32'(table_index)));
        TableSelectOffset:
          table_select <= SelectWidth'(merged(32'(table_select) << TableSelectSelectLsb) >> TableSelectSelectLsb);
        TableHighOffset: table_high <= merged(table_high);
        DarkLevelOffset: dark_level <= 8'(merged(32'(dark_level)));
        CaptureOffset:
          capture_log2_frames <=
              4'(merged(32'(capture_log2_frames) << CaptureLog2FramesLsb) >> CaptureLog2FramesLsb);
        FloorCaptureOffset:
          floor_log2_frames <=
              4'(merged(32'(floor_log2_frames) << FloorCaptureLog2FramesLsb) >> FloorCaptureLog2FramesLsb);
        OffThresholdOffset: off_threshold <= $signed(merged(off_threshold));
        MinimumAreaOffset: minimum_area <= merged(minimum_area);
        DebounceOffset: debounce <= 8'(merged(32'(debounce)));
        default: ;
      endcase
    end
    if (table_write || (table_read && read_is_low)) begin
      table_index <= table_index == table_last ? '0 : table_index + IndexWidth'(1);
    end

    // Banks.
    requested <= (requested & {Tables{!frame_start}}) | (commits & Present & ~closed) | captured;
    if (changes) bank <= table_bank;

    // Registers that the pipeline writes.
    status <= (status & ~status_cleared) | status_set;
    frames_in <= counted(frames_in, 8'(event_frame_in));
    frames_out <= counted(frames_out, 8'(event_frame_out));
    frames_dropped <= counted(frames_dropped, 8'(event_frame_dropped));
    saturations_count <= counted(saturations_count, saturations);
    dark_pixels <= counted(dark_pixels, 8'(event_dark));
    depth_dropped <= counted(depth_dropped, 8'(event_depth_dropped));
    records_lost <= counted(records_lost, 8'(event_record_lost));
    if (first_depth_latency_valid) last_latency <= first_depth_latency;

    // Read channels.
    if (s_axil_rvalid && s_axil_rready) s_axil_rvalid <= 1'b0;
    reading <= {reading[2:0], 1'b0};
    if (reading[0]) read_inside <= inside_table;
    if (reading[3]) begin
      s_axil_rvalid <= 1'b1;
      s_axil_rresp <= read_inside ? Okay : SlaveError;
      s_axil_rdata <= !read_inside ? 32'd0 : read_is_low ? table_read_low : table_read_high;
    end
    if (s_axil_arvalid && s_axil_arready) begin
      s_axil_rvalid <= 1'b1;
      s_axil_rresp <= Okay;
      case (read_offset)
        IdOffset: s_axil_rdata <= IdReset;
        GridOffset: s_axil_rdata <= GridWord;
        FormatOffset: s_axil_rdata <= FormatWord;
        ControlOffset:
          s_axil_rdata <=
              (32'(hold_contact) << ControlHoldContactBit) | (32'(drop_frames) << ControlDropFramesBit);
        StatusOffset:
          s_axil_rdata <=
              status | (32'(busy) << StatusBusyBit) | (32'(contact) << StatusContactBit)
              | (32'(touching) << StatusTouchingBit);
        ThresholdOffset: s_axil_rdata <= threshold;
        TimeoutOffset: s_axil_rdata <= timeout;
        FramesInOffset: s_axil_rdata <= frames_in;
        FramesOutOffset: s_axil_rdata <= frames_out;
        FramesDroppedOffset: s_axil_rdata <= frames_dropped;
        SaturationsOffset: s_axil_rdata <= saturations_count;
        FirstDepthLatencyOffset: s_axil_rdata <= last_latency;
        TableIndexOffset: s_axil_rdata <= 32'(table_index);
        TableSelectOffset: s_axil_rdata <= 32'(table_select) << TableSelectSelectLsb;
        TableHighOffset, TableLowOffset: begin
          reading[0] <= 1'b1;
          read_is_low <= read_offset == TableLowOffset;
          s_axil_rvalid <= 1'b0;
        end
        TableCommitOffset: s_axil_rdata <= 32'(pending);
        TableSizeOffset: s_axil_rdata <= table_size;
        DarkLevelOffset: s_axil_rdata <= 32'(dark_level);
        CaptureOffset:
          s_axil_rdata <=
              (32'(capture_log2_frames) << CaptureLog2FramesLsb) | (32'(capture_busy) << CaptureBusyBit);
        FloorCaptureOffset:
          s_axil_rdata <=
              (32'(floor_log2_frames) << FloorCaptureLog2FramesLsb) | (32'(floor_busy) << FloorCaptureBusyBit);
        DarkPixelsOffset: s_axil_rdata <= dark_pixels;
        DepthDroppedOffset: s_axil_rdata <= depth_dropped;
        RecordsLostOffset: s_axil_rdata <= records_lost;
        OffThresholdOffset: s_axil_rdata <= off_threshold;
        MinimumAreaOffset: s_axil_rdata <= minimum_area;
        DebounceOffset: s_axil_rdata <= 32'(debounce);
        RecordEventOffset: s_axil_rdata <= record[32*0+:32];
        RecordFrameOffset: s_axil_rdata <= record[32*1+:32];
        RecordTimeOffset: s_axil_rdata <= record[32*2+:32];
        RecordAreaOffset: s_axil_rdata <= record[32*3+:32];
        RecordPeakOffset: s_axil_rdata <= record[32*4+:32];
        RecordPeakPlaceOffset: s_axil_rdata <= record[32*5+:32];
        RecordLeastOffset: s_axil_rdata <= record[32*6+:32];
        RecordGreatestOffset: s_axil_rdata <= record[32*7+:32];
        RecordSumColumnsOffset: s_axil_rdata <= record[32*8+:32];
        RecordSumRowsOffset: s_axil_rdata <= record[32*9+:32];
        RecordVolumeLowOffset: s_axil_rdata <= record[32*10+:32];
        RecordVolumeHighOffset: s_axil_rdata <= record[32*11+:32];
        RecordCentroidOffset: s_axil_rdata <= record[32*12+:32];
        default: begin
          s_axil_rdata <= 32'd0;
          s_axil_rresp <= SlaveError;
        end
      endcase
    end

    if (rst) begin
      aw_held <= 1'b0;
      w_held <= 1'b0;
      s_axil_bvalid <= 1'b0;
      s_axil_rvalid <= 1'b0;
      hold_contact <= 1'b0;
      drop_frames <= 1'b0;
      threshold <= ThresholdReset;
      off_threshold <= OffThresholdReset;
      minimum_area <= MinimumAreaReset;
      debounce <= 8'(DebounceReset);
      dark_level <= 8'd0;
      capture_log2_frames <= 4'd0;
      floor_log2_frames <= 4'd0;
      timeout <= 32'd0;
      table_select <= '0;
      table_index <= '0;
      table_high <= '0;
      requested <= '0;
      reading <= '0;
      status <= 32'd0;
      frames_in <= 32'd0;
      frames_out <= 32'd0;
      frames_dropped <= 32'd0;
      saturations_count <= 32'd0;
      dark_pixels <= 32'd0;
      depth_dropped <= 32'd0;
      records_lost <= 32'd0;
      last_latency <= 32'd0;
    end
  end

  logic unused_address;
  assign unused_address = &{1'b0, write_address[1:0], s_axil_araddr[1:0]};

`ifndef SYNTHESIS
  initial begin
    if (Rows < 1 || Rows > 65535) $fatal(1, "%m: Rows does not fit GRID");
    if (Columns < 1 || Columns > 65535) $fatal(1, "%m: Columns does not fit GRID");
    if (GradientWidth < 2 || GradientWidth > 32) $fatal(1, "%m: GradientWidth must be 2 to 32");
    if (BitsPerChannel < 0 || BitsPerChannel > 8) $fatal(1, "%m: BitsPerChannel must be 0 to 8");
  end
`endif

endmodule
