// SPDX-License-Identifier: Apache-2.0
// tactile_depth: RGB frames of a lit gel in, depth maps and contact out.
//
//   axis_skid -> frame_guard -> gradient_lookup -> divergence -> solver -> frame_output -> axis_skid
//                     |                                                                  |             |
//                     +------------------------- frame_tags -----------------------------+     threshold_comparator
//
// Stream in: AXI4-Stream Video, R in 23:16, B in 15:8, G in 7:0, raster order, one pixel per clock sustained.
// Stream out: depth codes in raster order (tridiagonal: bottom row first), tuser with the first of a frame, tlast with
// the last of a row, sign-extended to whole bytes; depth_mm = code * depth_lsb_mm, pressed in is positive.
// Latency: fixed, models/latency.py. Gaps in the input change no result, and not the clocks from the last pixel to the
// first depth. A stalled sink stops the pipeline. Registers: docs/registers.md. Parameters: models/configuration.py.
// Bit-accurate model: models/tactile_depth.py.

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
  parameter int StoreDrop        = 3,    // from here: tridiagonal
  parameter int TableWords       = 1379,
  parameter int SettledWidth     = 7,
  parameter int LastShiftWidth   = 1,
  parameter int MomentDrop       = 7,
  parameter int MeanReciprocal   = 65536,
  parameter int MeanDrop         = 16,
  parameter int FrameLatency     = 17167,  // last pixel out of the guard to first depth out of the solver
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

  // Depth.

  localparam int Tables = TableSelectSelectCount;
  logic table_write, table_read, gradient_selected, gradient_bank, gradient_in_use;
  logic [TableSelectSelectWidth-1:0] table_select;
  logic [3*BitsPerChannel-1:0] table_index;
  logic [31:0] table_high, table_low;
  logic [Tables-1:0] table_bank, table_in_use;
  logic signed [GradientWidth-1:0] table_gx, table_gy, gx, gy;
  // Constants of the package stand in no port connection: there Icarus 11 takes their names for new, undriven nets.
  assign gradient_bank = table_bank[TableSelectGradient];
  assign table_in_use = Tables'(gradient_in_use) << TableSelectGradient;
  assign gradient_selected = table_select == TableSelectSelectWidth'(TableSelectGradient);
  logic slope_valid;
  logic [3:0] slope_place;
  gradient_lookup #(.Width(GradientWidth), .BitsPerChannel(BitsPerChannel)) u_lookup (
    .clk, .rst, .en,
    .table_bank(gradient_bank), .table_in_use(gradient_in_use),
    .table_write(table_write & gradient_selected), .table_read(table_read & gradient_selected), .table_index,
    .table_gx(table_low[GradientWidth-1:0]), .table_gy(table_high[GradientWidth-1:0]),
    .table_read_gx(table_gx), .table_read_gy(table_gy),
    .in_valid(guarded_valid), .in_pixel(guarded_data), .in_place(guarded_place),
    .out_valid(slope_valid), .out_place(slope_place),
    .out_gx(gx), .out_gy(gy)
  );

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
      .MeanReciprocal(MeanReciprocal), .MeanDrop(MeanDrop)
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
      .DivideShiftWidth(DivideShiftWidth), .DivideDrop(DivideDrop), .Neumann(Neumann)
    ) u_solver (
      .clk, .rst, .en, .in_valid(divergence_valid), .in_frame_start(divergence_frame_start),
      .in_data(divergence_data),
      .out_start(solved_start), .out_frame_start(solved_frame_start), .out_data(solved_data), .saturations
    );
  end

  // Frames. A tag is the mark of a broken frame and the clock that took the first pixel.

  logic [31:0] now, arrived, begun;
  logic frame_due, tags_held, tag_bad, depth_active, solved_last, out_of_step;
  logic [31:0] tag_begun;
  frame_tags #(.Width(33), .Latency(FrameLatency), .Pixels(Rows * Size)) u_tags (
    .clk, .rst, .en, .push(guarded_end), .tag({guarded_bad, begun}),
    .due(frame_due), .due_tag({tag_bad, tag_begun}), .held(tags_held)
  );

  logic depth_valid, depth_last, depth_user;
  logic [DataWidth-1:0] depth_data;
  frame_output #(.Width(DataWidth), .Rows(Rows), .Columns(Size)) u_output (
    .clk, .rst, .en, .in_start(solved_start), .in_frame_start(solved_frame_start), .in_data(solved_data),
    .in_due(frame_due), .in_bad(tag_bad), .active(depth_active), .frame_end(solved_last), .out_of_step,
    .out_valid(depth_valid), .out_data(depth_data), .out_last(depth_last), .out_user(depth_user)
  );

  logic leaving_last_of_frame;
  logic signed [DataWidth-1:0] leaving_data;
  axis_skid #(.Width(DataWidth + 3)) u_skid_out (
    .clk, .rst,
    .s_valid(depth_valid), .s_ready(en), .s_data({solved_last, depth_user, depth_last, depth_data}),
    .m_valid(m_axis_tvalid), .m_ready(m_axis_tready),
    .m_data({leaving_last_of_frame, m_axis_tuser, m_axis_tlast, leaving_data})
  );
  assign m_axis_tdata = (8 * DepthBytes)'(leaving_data);

  logic leaves, hold_contact;
  logic signed [31:0] threshold;
  assign leaves = m_axis_tvalid & m_axis_tready;
  threshold_comparator #(.Width(DataWidth)) u_comparator (
    .clk, .rst, .in_valid(leaves), .in_user(m_axis_tuser), .in_data(leaving_data),
    .threshold, .hold(hold_contact), .contact
  );

  // Clocks from the first pixel taken to the first depth on the output. Whether a frame is in flight.

  logic [31:0] depth_begun;
  logic depth_awaited, latency_valid, taking, busy;
  assign busy = pixel_valid | guarded_start | taking | tags_held | depth_active;
  assign latency_valid = depth_awaited & m_axis_tvalid & m_axis_tuser;
  always_ff @(posedge clk) begin
    now <= now + 32'd1;
    if (s_axis_tvalid && s_axis_tready && s_axis_tuser) arrived <= now;
    if (en && guarded_start) begun <= arrived;
    if (en && depth_valid && depth_user) begin
      depth_begun <= tag_begun;
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

  // Of cores that are not connected.
  logic drop_frames, capture_request;
  logic [3:0] capture_log2_frames;
  logic [7:0] dark_level, debounce;
  logic [31:0] minimum_area;
  logic signed [31:0] off_threshold;
  logic unused_settings;
  assign unused_settings = ^{drop_frames, capture_request, capture_log2_frames, dark_level, debounce, minimum_area,
                             off_threshold};

  axil_registers #(
    .Rows(Rows), .Columns(Size), .DataWidth(DataWidth), .GradientWidth(GradientWidth),
    .GradientFraction(GradientFraction), .BitsPerChannel(BitsPerChannel)
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
    .event_dark(1'b0), .event_depth_dropped(1'b0), .event_record_lost(1'b0),
    .saturations,
    .first_depth_latency(now - depth_begun), .first_depth_latency_valid(latency_valid),
    .busy, .contact, .touching(1'b0), .record('0),
    .threshold, .off_threshold, .minimum_area, .debounce, .timeout, .hold_contact, .drop_frames, .dark_level,
    .capture_request, .capture_log2_frames, .capture_busy(1'b0), .capture_done(1'b0),
    .frame_start(en & guarded_start), .table_write, .table_read, .table_select, .table_index, .table_high, .table_low,
    .table_read_high(32'(table_gy)), .table_read_low(32'(table_gx)), .table_bank,
    .table_in_use
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
