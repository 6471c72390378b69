// SPDX-License-Identifier: Apache-2.0
// tactile_depth: RGB frames of a lit gel in, depth maps and contact out.
//
//   axis_skid -> frame_guard -> [flat_field] -> gradient -> divergence -> solver -> frame_output -> [auto_zero]
//                     |                                                                 |               |
//                     +- [reference_capture]                        [floor_capture] ----+           depth_gate
//                     +--------------------------- frame_tags --------------------------+               |
//                                                                       threshold_comparator, contact_events
//   gradient: gradient_lookup or quadratic_gradient, from its parameter. In brackets: with FlatField, with AutoZero.
//
// Stream in: AXI4-Stream Video, R in 23:16, B in 15:8, G in 7:0, raster order, one pixel per clock sustained.
// Stream out: depth codes in raster order (tridiagonal: bottom row first), tuser with the first of a frame, tlast with
// the last of a row, sign-extended to whole bytes; depth_mm = code * depth_lsb_mm, pressed in is positive.
// Latency: fixed, models/tactile_depth/latency.py. Gaps in the input change no result, and not the clocks from the
// last pixel to the
// first depth. A stalled sink stops the pipeline. Registers: docs/registers.md. Parameters:
// models/tactile_depth/configuration.py.
// Bit-accurate model: models/tactile_depth/tactile_depth.py.

module tactile_depth
  import register_map_pkg::*;
#(
  parameter int Tridiagonal      = 0,    // solver: 0 spectral, 1 tridiagonal
  parameter int Neumann          = 0,    // 1: zero slope at the frame's edge
  parameter int Rows             = 128,
  parameter int Size             = 128,  // columns
  parameter int BitsPerChannel   = 4,
  parameter int GradientWidth    = 21,
  parameter int GradientFraction = 20,
  parameter int DataWidth        = 24,
  parameter int Width            = 27,
  parameter int CoeffWidth       = 18,
  parameter int RowForwardOut    = 3,
  parameter int ColumnForwardIn  = 1,
  parameter int ColumnInverseOut = -1,
  parameter int RowInverseIn     = -3,
  parameter int RowInverseOut    = -1,
  parameter int DivideShiftWidth = 4,
  parameter int DivideDrop       = 23,
  parameter int StoreStyle       = 1,    // of a frame store, hdl/common/ram.sv
  parameter int StoreDrop        = 3,    // from here: tridiagonal
  parameter int TableWords       = 1379,
  parameter int SettledWidth     = 7,
  parameter int LastShiftWidth   = 1,
  parameter int MomentDrop       = 7,
  parameter int MeanReciprocal   = 65536,
  parameter int MeanDrop         = 16,
  parameter int WordsPerRow      = 1,    // of the frame store's memory
  parameter int FrameLatency     = 17221,  // last pixel out of the guard to first depth out of the solver
  parameter int FlatField        = 0,    // 1: colours relative to a reference frame
  parameter int Quadratic        = 0,    // gradient model: 0 table, 1 quadratics, which need FlatField
  parameter int AutoZero         = 0,    // 1: depth less what it reads where nothing touches
  parameter int BlockLog2        = 3,    // FlatField, AutoZero
  parameter int FloorLog2        = 8,    // AutoZero
  parameter int GainWidth        = 24,   // from here: FlatField
  parameter int GainFraction     = 27,
  parameter int CaptureLog2      = 8,
  parameter int ColourWidth      = 8,
  parameter int ColourDrop       = 20,
  parameter int ColourOffset     = 0,
  parameter int ColourFlat       = 128,
  parameter int PolynomialWords  = 36,   // from here: Quadratic
  parameter int PolynomialWidth  = 32,
  parameter int ColourCoeffWidth = 18,
  parameter int SlopeDrop        = 6,
  localparam int DepthBytes = (DataWidth + 7) / 8
) (
  input  logic                    clk,
  input  logic                    rst,  // synchronous; resets valid, ready and state, never the data path

  input  logic [23:0]             s_axis_tdata,
  input  logic                    s_axis_tvalid,
  output logic                    s_axis_tready,
  input  logic                    s_axis_tlast,
  input  logic                    s_axis_tuser,

  output logic [8*DepthBytes-1:0] m_axis_tdata,
  output logic                    m_axis_tvalid,
  input  logic                    m_axis_tready,
  output logic                    m_axis_tlast,
  output logic                    m_axis_tuser,

  output logic                    contact,

  output logic [31:0]             m_event_tdata,
  output logic                    m_event_tvalid,
  input  logic                    m_event_tready,
  output logic                    m_event_tlast,

  input  logic [AddressWidth-1:0] s_axil_awaddr,
  input  logic                    s_axil_awvalid,
  output logic                    s_axil_awready,
  input  logic [31:0]             s_axil_wdata,
  input  logic [3:0]              s_axil_wstrb,
  input  logic                    s_axil_wvalid,
  output logic                    s_axil_wready,
  output logic [1:0]              s_axil_bresp,
  output logic                    s_axil_bvalid,
  input  logic                    s_axil_bready,
  input  logic [AddressWidth-1:0] s_axil_araddr,
  input  logic                    s_axil_arvalid,
  output logic                    s_axil_arready,
  output logic [31:0]             s_axil_rdata,
  output logic [1:0]              s_axil_rresp,
  output logic                    s_axil_rvalid,
  input  logic                    s_axil_rready
);

  logic en;  // the whole pipeline moves, or none of it: low while the output is full

  // Pixels.

  logic pixel_valid, pixel_ready, pixel_last, pixel_user;
  logic [23:0] pixel_data;
  axis_skid #(.Width(26)) u_skid_in (
    .clk, .rst,
    .s_valid(s_axis_tvalid), .s_ready(s_axis_tready), .s_data({s_axis_tuser, s_axis_tlast, s_axis_tdata}),
    .m_valid(pixel_valid), .m_ready(pixel_ready), .m_data({pixel_user, pixel_last, pixel_data})
  );

  logic [31:0] timeout;
  logic [3:0] guarded_place;
  logic guarded_valid, guarded_start, guarded_end, guarded_bad;
  logic [23:0] guarded_data;
  logic row_short, row_long, start_missing, start_early, timed_out;
  frame_guard #(.Rows(Rows), .Columns(Size)) u_guard (
    .clk, .rst, .en, .timeout,
    .s_valid(pixel_valid), .s_ready(pixel_ready),
    .s_data(pixel_data), .s_last(pixel_last), .s_user(pixel_user),
    .out_valid(guarded_valid), .out_data(guarded_data),
    .out_first_row(guarded_place[0]), .out_first_column(guarded_place[1]),
    .out_last_row(guarded_place[2]), .out_last_column(guarded_place[3]),
    .out_frame_start(guarded_start), .out_frame_end(guarded_end), .out_bad(guarded_bad),
    .row_short, .row_long, .start_missing, .start_early, .timed_out
  );

  // Colours, relative to the reference if there is one, and their slopes.

  localparam int Tables = TableSelectSelectCount;
  localparam int RecordWords = (RecordCentroidOffset - RecordEventOffset) / 4 + 1;
  localparam int GradientWords = Quadratic != 0 ? 0 : 1 << (3 * BitsPerChannel);
  localparam int CoefficientWords = Quadratic != 0 ? PolynomialWords : 0;
  localparam int ReferenceWords = FlatField != 0 ? 4 * (Rows >> BlockLog2) * (Size >> BlockLog2) : 0;
  localparam int FloorWords = AutoZero != 0 ? (Rows >> BlockLog2) * (Size >> BlockLog2) : 0;
  localparam int MapWords = ReferenceWords > FloorWords ? ReferenceWords : FloorWords;
  localparam int SlopeWords = GradientWords > CoefficientWords ? GradientWords : CoefficientWords;
  localparam int IndexWidth = $clog2(SlopeWords > MapWords ? SlopeWords : MapWords);
  logic table_write, table_read, gradient_selected, coefficients_selected, reference_selected, floor_selected;
  logic [TableSelectSelectWidth-1:0] table_select;
  logic [IndexWidth-1:0] table_index;
  logic [31:0] table_high, table_low, table_read_high, table_read_low;
  logic [31:0] reference_word, floor_word, slope_high, slope_low;
  logic [Tables-1:0] table_bank, table_in_use;
  logic slope_bank, slope_in_use, reference_bank, reference_in_use, floor_bank, floor_in_use;
  // Constants of the package stand in no port connection: there Icarus 11 takes their names for new, undriven nets.
  assign slope_bank = Quadratic != 0 ? table_bank[TableSelectCoefficients] : table_bank[TableSelectGradient];
  assign reference_bank = table_bank[TableSelectReference];
  assign floor_bank = table_bank[TableSelectFloor];
  assign table_in_use = (Tables'(reference_in_use) << TableSelectReference)
      | (Tables'(floor_in_use) << TableSelectFloor)
      | (Tables'(slope_in_use) << (Quadratic != 0 ? TableSelectCoefficients : TableSelectGradient));
  assign gradient_selected = table_select == TableSelectSelectWidth'(TableSelectGradient);
  assign coefficients_selected = table_select == TableSelectSelectWidth'(TableSelectCoefficients);
  assign reference_selected = table_select == TableSelectSelectWidth'(TableSelectReference);
  assign floor_selected = table_select == TableSelectSelectWidth'(TableSelectFloor);
  assign table_read_high = reference_selected | floor_selected ? 32'd0 : slope_high;
  assign table_read_low = reference_selected ? reference_word : floor_selected ? floor_word : slope_low;

  logic colour_valid, dark, capture_request, capture_busy, capture_done;
  logic [3:0] colour_place, capture_log2_frames;
  logic [ColourWidth-1:0] red, green, blue;
  logic [7:0] dark_level;
  logic [1:0] colour_saturations, slope_saturations;
  if (FlatField != 0) begin : g_flat_field
    localparam int NodeWidth = $clog2(ReferenceWords / 4);
    logic capture_write, capture_read;
    logic [NodeWidth-1:0] capture_write_node, capture_read_node;
    logic [3*GainWidth-1:0] captured, capture_read_gains;
    logic [GainWidth-1:0] table_read_gain;
    flat_field #(
      .Rows(Rows), .Columns(Size), .BlockLog2(BlockLog2), .GainWidth(GainWidth), .Drop(ColourDrop),
      .Offset(ColourOffset), .OutWidth(ColourWidth), .Flat(ColourFlat)
    ) u_flat_field (
      .clk, .rst, .en, .dark_level,
      .table_bank(reference_bank), .table_in_use(reference_in_use),
      .table_write(table_write & reference_selected), .table_read(table_read & reference_selected),
      .table_index(table_index[NodeWidth+1:0]), .table_gain(table_low[GainWidth-1:0]), .table_read_gain,
      .capture_write, .capture_write_node, .capture_gains(captured),
      .capture_read, .capture_read_node, .capture_read_gains,
      .in_valid(guarded_valid), .in_pixel(guarded_data), .in_place(guarded_place),
      .out_valid(colour_valid), .out_place(colour_place), .out_red(red), .out_green(green), .out_blue(blue),
      .dark, .saturations(colour_saturations)
    );
    reference_capture #(
      .Rows(Rows), .Columns(Size), .BlockLog2(BlockLog2), .Width(GainWidth), .GainFraction(GainFraction),
      .MaxLog2(CaptureLog2)
    ) u_capture (
      .clk, .rst, .en, .request(capture_request), .log2_frames(capture_log2_frames),
      .busy(capture_busy), .done(capture_done),
      .in_valid(guarded_valid), .in_pixel(guarded_data), .in_place(guarded_place), .in_bad(guarded_bad),
      .map_write(capture_write), .map_write_node(capture_write_node), .map_write_gains(captured),
      .map_read(capture_read), .map_read_node(capture_read_node), .map_read_gains(capture_read_gains)
    );
    assign reference_word = 32'(table_read_gain);
  end else begin : g_as_sent
    assign {red, blue, green} = guarded_data;
    assign colour_valid = guarded_valid;
    assign colour_place = guarded_place;
    assign {dark, colour_saturations, capture_busy, capture_done, reference_in_use} = '0;
    assign reference_word = '0;
    logic unused_reference;
    assign unused_reference = ^{dark_level, capture_request, capture_log2_frames, reference_bank};
  end

  logic slope_valid;
  logic [3:0] slope_place;
  logic signed [GradientWidth-1:0] gx, gy;
  if (Quadratic != 0) begin : g_quadratic
    logic signed [PolynomialWidth-1:0] table_read_word;
    quadratic_gradient #(
      .Width(GradientWidth), .DeviationWidth(ColourWidth), .CoeffWidth(ColourCoeffWidth),
      .WordWidth(PolynomialWidth), .Drop(SlopeDrop)
    ) u_quadratic (
      .clk, .rst, .en,
      .table_bank(slope_bank), .table_in_use(slope_in_use),
      .table_write(table_write & coefficients_selected), .table_read(table_read & coefficients_selected),
      .table_index(table_index[$clog2(PolynomialWords)-1:0]),
      .table_word(table_low[PolynomialWidth-1:0]), .table_read_word,
      .in_valid(colour_valid), .in_place(colour_place),
      .in_red(red), .in_green(green), .in_blue(blue),
      .out_valid(slope_valid), .out_place(slope_place), .out_gx(gx), .out_gy(gy), .saturations(slope_saturations)
    );
    assign slope_high = '0;
    assign slope_low = 32'(table_read_word);
    logic unused_selected;
    assign unused_selected = gradient_selected;
  end else begin : g_lookup
    logic signed [GradientWidth-1:0] table_read_gx, table_read_gy;
    gradient_lookup #(.Width(GradientWidth), .BitsPerChannel(BitsPerChannel)) u_lookup (
      .clk, .rst, .en,
      .table_bank(slope_bank), .table_in_use(slope_in_use),
      .table_write(table_write & gradient_selected), .table_read(table_read & gradient_selected),
      .table_index(table_index[3*BitsPerChannel-1:0]),
      .table_gx(table_low[GradientWidth-1:0]), .table_gy(table_high[GradientWidth-1:0]),
      .table_read_gx, .table_read_gy,
      .in_valid(colour_valid), .in_pixel({red, blue, green}), .in_place(colour_place),
      .out_valid(slope_valid), .out_place(slope_place),
      .out_gx(gx), .out_gy(gy)
    );
    assign slope_high = 32'(table_read_gy);
    assign slope_low = 32'(table_read_gx);
    assign slope_saturations = '0;
    logic unused_selected;
    assign unused_selected = coefficients_selected;
  end

  // Depth.

  logic divergence_valid, divergence_frame_start;
  logic signed [GradientWidth+1:0] divergence_data;
  divergence #(.Width(GradientWidth), .Columns(Size), .Neumann(Neumann)) u_divergence (
    .clk, .rst, .en,
    .in_valid(slope_valid), .in_first_row(slope_place[0]), .in_first_column(slope_place[1]),
    .in_last_row(slope_place[2]), .in_last_column(slope_place[3]),
    .in_gx(gx), .in_gy(gy),
    .out_valid(divergence_valid), .out_frame_start(divergence_frame_start), .out_data(divergence_data)
  );

  logic solved_start, solved_frame_start;
  logic signed [DataWidth-1:0] solved_data;
  logic [7:0] saturations;
  if (Tridiagonal != 0) begin : g_tridiagonal
    tridiagonal_solver #(
      .Rows(Rows), .Size(Size), .InWidth(GradientWidth + 2), .DataWidth(DataWidth), .Width(Width),
      .CoeffWidth(CoeffWidth), .Neumann(Neumann), .RowForwardOut(RowForwardOut), .StoreDrop(StoreDrop),
      .RowInverseIn(RowInverseIn), .RowInverseOut(RowInverseOut), .TableWords(TableWords),
      .SettledWidth(SettledWidth), .LastShiftWidth(LastShiftWidth), .MomentDrop(MomentDrop),
      .MeanReciprocal(MeanReciprocal), .MeanDrop(MeanDrop), .StoreStyle(StoreStyle), .WordsPerRow(WordsPerRow)
    ) u_solver (
      .clk, .rst, .en, .in_valid(divergence_valid), .in_frame_start(divergence_frame_start),
      .in_data(divergence_data),
      .out_start(solved_start), .out_frame_start(solved_frame_start), .out_data(solved_data), .saturations
    );
  end else begin : g_spectral
    spectral_solver #(
      .Size(Size), .InWidth(GradientWidth + 2), .DataWidth(DataWidth), .Width(Width), .CoeffWidth(CoeffWidth),
      .RowForwardOut(RowForwardOut), .ColumnForwardIn(ColumnForwardIn), .ColumnInverseOut(ColumnInverseOut),
      .RowInverseIn(RowInverseIn), .RowInverseOut(RowInverseOut),
      .DivideShiftWidth(DivideShiftWidth), .DivideDrop(DivideDrop), .Neumann(Neumann), .StoreStyle(StoreStyle)
    ) u_solver (
      .clk, .rst, .en, .in_valid(divergence_valid), .in_frame_start(divergence_frame_start),
      .in_data(divergence_data),
      .out_start(solved_start), .out_frame_start(solved_frame_start), .out_data(solved_data), .saturations
    );
  end

  // Frames. A tag is the mark of a broken frame, the bank of the floor that it uses, and the clock that took the first
  // pixel.

  logic [31:0] now, arrived, begun;
  logic frame_due, tags_held, tag_bad, tag_bank, output_active, output_end, out_of_step;
  logic [31:0] tag_begun;
  frame_tags #(.Width(34), .Latency(FrameLatency), .Pixels(Rows * Size)) u_tags (
    .clk, .rst, .en, .push(guarded_end), .tag({guarded_bad, floor_bank, begun}),
    .due(frame_due), .due_tag({tag_bad, tag_bank, tag_begun}), .held(tags_held)
  );

  logic output_valid, output_last, output_user;
  logic signed [DataWidth-1:0] output_data;
  frame_output #(.Width(DataWidth), .Rows(Rows), .Columns(Size)) u_output (
    .clk, .rst, .en, .in_start(solved_start), .in_frame_start(solved_frame_start), .in_data(solved_data),
    .in_due(frame_due), .in_bad(tag_bad), .active(output_active), .frame_end(output_end), .out_of_step,
    .out_valid(output_valid), .out_data(output_data), .out_last(output_last), .out_user(output_user)
  );

  // The floor. The bank goes with the frame: while it was in the solver others have begun.

  logic depth_valid, depth_last, depth_user, depth_end, depth_active;
  logic floor_request, floor_busy, floor_done, floor_saturation;
  logic [3:0] floor_log2_frames;
  logic [31:0] output_begun;
  logic signed [DataWidth-1:0] depth_data;
  if (AutoZero != 0) begin : g_auto_zero
    localparam int NodeWidth = $clog2(FloorWords);
    logic zero_active, bank_q, floor_write;
    logic [NodeWidth-1:0] floor_write_node;
    logic signed [DataWidth-1:0] floor_written, table_read_floor;
    auto_zero #(.Rows(Rows), .Columns(Size), .BlockLog2(BlockLog2), .Width(DataWidth)) u_auto_zero (
      .clk, .rst, .en,
      .table_bank(rst ? floor_bank : bank_q), .table_in_use(floor_in_use),
      .table_write(table_write & floor_selected), .table_read(table_read & floor_selected),
      .table_index(table_index[NodeWidth-1:0]), .table_floor(table_low[DataWidth-1:0]), .table_read_floor,
      .capture_write(floor_write), .capture_write_node(floor_write_node), .capture_floor(floor_written),
      .in_valid(output_valid), .in_user(output_user), .in_last(output_last), .in_frame_end(output_end),
      .in_data(output_data),
      .out_valid(depth_valid), .out_user(depth_user), .out_last(depth_last), .out_frame_end(depth_end),
      .out_data(depth_data), .active(zero_active), .saturation(floor_saturation)
    );
    floor_capture #(
      .Rows(Rows), .Columns(Size), .BlockLog2(BlockLog2), .Width(DataWidth), .MaxLog2(FloorLog2)
    ) u_floor_capture (
      .clk, .rst, .en, .request(floor_request), .log2_frames(floor_log2_frames), .busy(floor_busy), .done(floor_done),
      .in_valid(output_valid), .in_user(output_user), .in_last(output_last), .in_frame_end(output_end),
      .in_data(output_data),
      .map_write(floor_write), .map_write_node(floor_write_node), .map_write_floor(floor_written)
    );
    assign floor_word = 32'(table_read_floor);
    assign depth_active = output_active | zero_active;
    always_ff @(posedge clk) begin
      if (en && frame_due) bank_q <= tag_bank;
      if (rst) bank_q <= floor_bank;
      if (en && output_valid && output_user) output_begun <= tag_begun;
    end
  end else begin : g_as_solved
    assign {depth_valid, depth_user, depth_last, depth_end} = {output_valid, output_user, output_last, output_end};
    assign depth_data = output_data;
    assign depth_active = output_active;
    assign output_begun = tag_begun;
    assign {floor_in_use, floor_busy, floor_done, floor_saturation} = '0;
    assign floor_word = '0;
    logic unused_floor;
    assign unused_floor = ^{floor_request, floor_log2_frames, floor_selected, tag_bank};
  end

  logic drop_frames, depth_dropped, leaving_last_of_frame, look_valid, look_user, look_last, look_frame_end;
  logic signed [DataWidth-1:0] leaving_data, look_data;
  depth_gate #(.Width(DataWidth)) u_gate (
    .clk, .rst, .drop_frames, .en,
    .in_valid(depth_valid), .in_user(depth_user), .in_last(depth_last), .in_frame_end(depth_end),
    .in_data(depth_data), .event_dropped(depth_dropped),
    .m_valid(m_axis_tvalid), .m_ready(m_axis_tready), .m_user(m_axis_tuser), .m_last(m_axis_tlast),
    .m_frame_end(leaving_last_of_frame), .m_data(leaving_data),
    .look_valid, .look_user, .look_last, .look_frame_end, .look_data(look_data)
  );
  assign m_axis_tdata = (8 * DepthBytes)'(leaving_data);

  logic leaves, hold_contact;
  logic signed [31:0] threshold;
  assign leaves = m_axis_tvalid & m_axis_tready;
  threshold_comparator #(.Width(DataWidth)) u_comparator (
    .clk, .rst, .in_valid(look_valid), .in_user(look_user), .in_data(look_data),
    .threshold, .hold(hold_contact), .contact
  );

  logic touching, record_lost, unused_record_valid;
  logic signed [31:0] off_threshold;
  logic [31:0] minimum_area, depth_begun;
  logic [7:0] debounce;
  logic [32*RecordWords-1:0] record;
  contact_events #(.Width(DataWidth), .Rows(Rows), .Columns(Size), .BottomFirst(Tridiagonal)) u_events (
    .clk, .rst, .in_valid(look_valid), .in_user(look_user), .in_last(look_last), .in_frame_end(look_frame_end),
    .in_data(look_data), .in_time(depth_begun), .on_threshold(threshold), .off_threshold, .minimum_area, .debounce,
    .touching, .record_valid(unused_record_valid), .record, .event_lost(record_lost),
    .m_event_tdata, .m_event_tvalid, .m_event_tready, .m_event_tlast
  );

  // Clocks from the first pixel taken to the first depth on the output. Whether a frame is in flight.

  logic depth_awaited, latency_valid, taking, busy;
  assign busy = pixel_valid | guarded_start | taking | tags_held | depth_active;
  assign latency_valid = depth_awaited & m_axis_tvalid & m_axis_tuser;
  always_ff @(posedge clk) begin
    now <= now + 32'd1;
    if (s_axis_tvalid && s_axis_tready && s_axis_tuser) arrived <= now;
    if (en && guarded_start) begun <= arrived;
    if (en && depth_valid && depth_user) begin
      depth_begun <= output_begun;
      depth_awaited <= 1'b1;
    end else if (latency_valid) begin
      depth_awaited <= 1'b0;
    end
    if (en) taking <= (guarded_start | taking) & ~guarded_end;
    if (rst) begin
      now <= '0;
      depth_awaited <= 1'b0;
      taking <= 1'b0;
    end
  end

  axil_registers #(
    .Rows(Rows), .Columns(Size), .DataWidth(DataWidth), .GradientWidth(GradientWidth),
    .GradientFraction(GradientFraction), .BitsPerChannel(Quadratic != 0 ? 0 : BitsPerChannel),
    .CoefficientWords(CoefficientWords), .ReferenceWords(ReferenceWords), .FloorWords(FloorWords)
  ) u_registers (
    .clk, .rst,
    .s_axil_awaddr, .s_axil_awvalid, .s_axil_awready, .s_axil_wdata, .s_axil_wstrb, .s_axil_wvalid,
    .s_axil_wready, .s_axil_bresp, .s_axil_bvalid, .s_axil_bready, .s_axil_araddr, .s_axil_arvalid,
    .s_axil_arready, .s_axil_rdata, .s_axil_rresp, .s_axil_rvalid, .s_axil_rready,
    .event_row_short(row_short), .event_row_long(row_long), .event_start_missing(start_missing),
    .event_start_early(start_early), .event_timeout(timed_out), .event_out_of_step(en & out_of_step),
    .event_frame_in(en & guarded_end & ~guarded_bad),
    .event_frame_out(leaves & leaving_last_of_frame),
    .event_frame_dropped(row_short | row_long | start_missing | start_early | timed_out),
    .event_dark(dark), .event_depth_dropped(depth_dropped), .event_record_lost(record_lost),
    .saturations(saturations + 8'(colour_saturations) + 8'(slope_saturations) + 8'(floor_saturation)),
    .first_depth_latency(now - depth_begun), .first_depth_latency_valid(latency_valid),
    .busy, .contact, .touching, .record, .capture_busy, .capture_done, .floor_busy, .floor_done,
    .threshold, .timeout, .hold_contact, .dark_level, .capture_request, .capture_log2_frames,
    .floor_request, .floor_log2_frames, .drop_frames,
    .off_threshold, .minimum_area, .debounce,
    .frame_start(en & guarded_start), .table_write, .table_read, .table_select, .table_index, .table_high, .table_low,
    .table_read_high, .table_read_low, .table_bank, .table_in_use
  );

  logic unused_tables;  // banks of the tables that this build has not, bits of wider entries than it has
  assign unused_tables = ^{table_bank, table_high, table_low};

`ifndef SYNTHESIS
  initial begin
    if (Tridiagonal == 0 && Rows != Size) $fatal(1, "%m: the spectral solver takes square grids: Rows must be Size");
    if (DataWidth > 32) $fatal(1, "%m: DataWidth must be at most 32");
  end
`endif

endmodule
