// SPDX-License-Identifier: Apache-2.0
// tactile_depth: RGB frames of a lit gel in, depth maps and contact out.
//
//   s_axis -> video_unit -> gradient_unit -> poisson_unit -> depth_unit -> contact_unit -> m_axis, contact, m_event
//                                    axil_registers <-> s_axil
//
// Stream in: AXI4-Stream Video, R in 23:16, B in 15:8, G in 7:0, raster order, a pixel a cycle; gaps change no result.
// Stream out: depth codes in raster order (tridiagonal: bottom row first), Lanes neighbours in a beat with the first in
// the lowest bits, each sign-extended to whole bytes; tuser with the first beat of a frame, tlast with the last of a
// row; depth_mm = code * depth_lsb_mm, pressed in is positive. A stalled sink stops the pipeline. Latency: fixed from
// the last pixel, models/tactile_depth/chip/latency.py. Bit-accurate model: models/tactile_depth/chip/tactile_depth.py.

`default_nettype none

module tactile_depth
  import td_config_pkg::*;
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter logic [ConfigBits-1:0] Config = DefaultConfig,  // hdl/td_config_pkg.sv
  localparam int Lanes         = value(Config, LanesField),  // depths in a beat
  localparam int DataWidth     = value(Config, DataWidthField),
  localparam int GradientWidth = value(Config, GradientWidthField),
  localparam int DepthBytes    = Lanes * ((DataWidth + 7) / 8)  // of a beat
) (
  input  wire                     clk,
  input  wire                     rst,  // synchronous; resets valid, ready and state, never the data path
  input  wire                     cold_rst,  // clears the banks of the tables too, at power-up; 0 on an FPGA

  input  wire  [23:0]             s_axis_tdata,
  input  wire                     s_axis_tvalid,
  output logic                    s_axis_tready,
  input  wire                     s_axis_tlast,
  input  wire                     s_axis_tuser,
  output logic [8*DepthBytes-1:0] m_axis_tdata,
  output logic                    m_axis_tvalid,
  input  wire                     m_axis_tready,
  output logic                    m_axis_tlast,
  output logic                    m_axis_tuser,
  output logic                    contact,
  output logic                    irq,  // level
  output logic [31:0]             m_event_tdata,
  output logic                    m_event_tvalid,
  input  wire                     m_event_tready,
  output logic                    m_event_tlast,

  input  wire  [AddressWidth-1:0] s_axil_awaddr,
  input  wire  [2:0]              s_axil_awprot,
  input  wire                     s_axil_awvalid,
  output logic                    s_axil_awready,
  input  wire  [31:0]             s_axil_wdata,
  input  wire  [3:0]              s_axil_wstrb,
  input  wire                     s_axil_wvalid,
  output logic                    s_axil_wready,
  output logic [1:0]              s_axil_bresp,
  output logic                    s_axil_bvalid,
  input  wire                     s_axil_bready,
  input  wire  [AddressWidth-1:0] s_axil_araddr,
  input  wire  [2:0]              s_axil_arprot,
  input  wire                     s_axil_arvalid,
  output logic                    s_axil_arready,
  output logic [31:0]             s_axil_rdata,
  output logic [1:0]              s_axil_rresp,
  output logic                    s_axil_rvalid,
  input  wire                     s_axil_rready,
  output register_command_t       register_command,  // to the registers of camera_unit
  input  wire register_answer_t   register_answer    // ignored without a camera in Config
);

  logic en_next, video_en, gradient_en, poisson_en, depth_en;  // the whole moves; low while the output is full
  td_enable u_en [3:0] (.clk, .rst, .en_next, .en({video_en, gradient_en, poisson_en, depth_en}));  // one a unit
  events_t events;
  levels_t levels;
  logic [31:0] timeout, now, frame_time, depth_time, first_depth_latency;
  logic self_test, video_busy, pixel_valid, pixel_frame_start, pixel_frame_end, pixel_bad, pixel_test, resumed;
  logic [23:0] pixel_data;
  position_t pixel_position;
  video_unit #(.Config(Config)) u_video (
    .clk, .rst, .en(video_en), .s_axis_tdata, .s_axis_tvalid, .s_axis_tready, .s_axis_tlast, .s_axis_tuser, .self_test,
    .timeout, .faults(events.faults), .hunting(levels.hunting), .arrived_columns(levels.arrived_columns),
    .arrived_rows(levels.arrived_rows), .busy(video_busy), .pixel_valid, .pixel_data, .pixel_position,
    .pixel_frame_start, .pixel_frame_end, .pixel_bad, .pixel_test, .resumed, .now, .frame_time
  );
  table_command_t table_command;
  table_answer_t slope_answer, zero_answer;
  capture_command_t reference_command, zero_command;
  capture_status_t reference_status, zero_status;
  logic [7:0] dark_level, slope_limit;
  logic [3:0] table_bank, slope_in_use, zero_in_use, slope_saturations;
  light_command_t light_command;
  logic [2:0][LightGainWidth-1:0] light_gains;
  logic slope_valid, slope_flags_valid, beyond;
  logic [2:0] flipped;  // in the slopes, the solver, the depth
  frame_flags_t slope_flags, depth_flags;
  position_t slope_position;
  logic signed [GradientWidth-1:0] slope_gx, slope_gy;
  gradient_unit #(.TableFolder(TableFolder), .Config(Config)) u_gradient (
    .clk, .rst, .en(gradient_en), .table_command, .table_answer(slope_answer), .table_bank, .table_in_use(slope_in_use),
    .dark_level, .slope_limit, .capture_command(reference_command), .capture_status(reference_status),
    .dark(events.dark), .light_command, .light_gains, .saturations(slope_saturations), .flipped(flipped[0]),
    .pixel_valid, .pixel_data, .pixel_position, .pixel_bad, .resumed, .slope_valid, .slope_position, .slope_gx,
    .slope_gy, .slope_flags_valid, .slope_flags
  );
  logic burst_start, solved_frame_start, out_of_step, depth_busy, depth_valid, first_depth_latency_valid;
  logic [Lanes*DataWidth-1:0] solved_data;
  logic [7+$clog2(Lanes):0] solver_saturations;
  logic [$clog2(Lanes):0] depth_saturations;
  poisson_unit #(.TableFolder(TableFolder), .Config(Config)) u_poisson (
    .clk, .rst, .en(poisson_en), .slope_valid, .slope_position, .slope_gx, .slope_gy, .burst_start,
    .depth_frame_start(solved_frame_start), .depth_data(solved_data), .saturations(solver_saturations),
    .flipped(flipped[1]), .residual(levels.residual), .beyond
  );
  depth_position_t depth_position;
  logic [Lanes*DataWidth-1:0] depth_data;
  depth_unit #(.TableFolder(TableFolder), .Config(Config)) u_depth (
    .clk, .rst, .en(depth_en), .table_command, .table_answer(zero_answer), .table_bank, .table_in_use(zero_in_use),
    .capture_command(zero_command), .capture_status(zero_status), .saturations(depth_saturations), .out_of_step,
    .flipped(flipped[2]), .busy(depth_busy), .pixel_frame_start, .pixel_frame_end, .pixel_bad, .pixel_test, .frame_time,
    .slope_flags_valid, .slope_flags, .burst_start, .solved_frame_start, .solved_data,
    .solver_clipped(solver_saturations != '0), .depth_valid, .depth_position, .depth_data, .depth_time, .depth_flags,
    .self_test, .test_signature(levels.self_test)
  );
  contact_settings_t contact_settings;
  logic [32*RecordWords-1:0] record;
  contact_unit #(.Config(Config)) u_contact (
    .clk, .rst, .en_next, .settings(contact_settings), .now, .frame_leaves(events.frame_out),
    .depth_dropped(events.depth_dropped), .stalled(levels.stalled), .record_valid(events.record_valid),
    .record_lost(events.record_lost), .touching(levels.touching), .record, .first_depth_latency,
    .first_depth_latency_valid, .depth_valid, .depth_position, .depth_data, .depth_time, .depth_flags, .flipped,
    .flip_found(events.flipped), .residual_found(events.residual), .beyond, .m_axis_tdata, .m_axis_tvalid,
    .m_axis_tready, .m_axis_tlast, .m_axis_tuser, .contact, .m_event_tdata, .m_event_tvalid, .m_event_tready,
    .m_event_tlast
  );
  assign events.out_of_step = depth_en & out_of_step;
  assign events.frame_in = video_en & pixel_frame_end & ~pixel_bad;
  assign events.saturations = 14'(solver_saturations) + 14'(slope_saturations) + 14'(depth_saturations);
  assign levels.busy = video_busy | depth_busy | m_axis_tvalid;
  assign levels.contact = contact;
  axil_registers #(.SignatureFile({TableFolder, "signatures.hex"}), .Config(Config)) u_registers (
    .clk, .rst, .cold_rst, .s_axil_awaddr, .s_axil_awprot, .s_axil_awvalid, .s_axil_awready, .s_axil_wdata,
    .s_axil_wstrb, .s_axil_wvalid, .s_axil_wready, .s_axil_bresp, .s_axil_bvalid, .s_axil_bready, .s_axil_araddr,
    .s_axil_arprot, .s_axil_arvalid, .s_axil_arready, .s_axil_rdata, .s_axil_rresp, .s_axil_rvalid, .s_axil_rready,
    .irq, .events, .levels, .first_depth_latency, .first_depth_latency_valid, .record, .contact_settings, .timeout,
    .self_test, .dark_level, .slope_limit, .light_command, .light_gains, .frame_start(video_en & pixel_frame_start),
    .table_command, .table_answer(slope_answer | zero_answer), .table_bank, .table_in_use(slope_in_use | zero_in_use),
    .reference_command, .reference_status, .zero_command, .zero_status, .register_command, .register_answer
  );

  // Refused.

  localparam int FlatField      = value(Config, FlatFieldField);
  localparam int Polynomial     = value(Config, PolynomialField);
  localparam int Dependent      = value(Config, CorrectionsField) | value(Config, LightGainsField);
  localparam int Options        = FlatField | Polynomial | Dependent | value(Config, ZeroOffsetField);
  localparam int BitsPerChannel = value(Config, BitsPerChannelField);
  localparam int GainWidth      = value(Config, GainWidthField);
  localparam int SumWidth       = 8 + 2 * value(Config, BlockLog2Field) + value(Config, CaptureLog2Field);
  localparam int FineBits       = value(Config, FineBitsField);
  localparam int CorrectionUnit = value(Config, CorrectionUnitField);
  localparam int Fraction       = value(Config, GradientFractionField);
  localparam int Mantissas      = value(Config, DepthMantissaField) | value(Config, SlopeMantissaField);
  localparam int DepthExponent  = value(Config, DepthExponentField);
  localparam int SlopeExponent  = value(Config, SlopeExponentField);
  if (Options < 0 || Options > 1) begin : g_refused_0
    FlatField_Polynomial_Corrections_LightGains_and_ZeroOffset_are_0_or_1 u_refused ();
  end
  if (Dependent > Polynomial || Polynomial > FlatField) begin : g_refused_1
    Corrections_and_LightGains_need_Polynomial_and_that_needs_FlatField u_refused ();
  end
  if (BitsPerChannel < 1 || BitsPerChannel > 8) begin : g_refused_2
    BitsPerChannel_must_be_1_to_8 u_refused ();
  end
  if (FlatField != 0 && (GainWidth < 2 || GainWidth > 32)) begin : g_refused_3
    GainWidth_must_be_2_to_32 u_refused ();
  end
  if (FlatField != 0 && SumWidth > GainWidth) begin : g_refused_4
    a_sum_of_a_block_over_2_to_the_CaptureLog2_frames_must_fit_GainWidth u_refused ();
  end
  if (Polynomial != 0 && PolynomialWidth + FineBits < ColourCoeffWidth) begin : g_refused_5
    FineBits_must_leave_a_coefficient_of_a_colour_in_the_words u_refused ();
  end
  if (Polynomial != 0 && (CorrectionUnit < 0
      || CorrectionWidth + $clog2(CorrectionUnit + 1) > DeviationWidth + ColourCoeffWidth + 1))
  begin : g_refused_6
    a_correction_must_fit_the_sum u_refused ();
  end
  if (value(Config, FrameLatencyField) < 2) begin : g_refused_7
    FrameLatency_must_be_at_least_2 u_refused ();
  end
  if (Fraction < 0 || Fraction > 255) begin : g_refused_8
    GradientFraction_does_not_fit_FORMAT u_refused ();
  end
  if (Mantissas >>> 24 != 0) begin : g_refused_9
    a_mantissa_does_not_fit_24_bits u_refused ();
  end
  if (DepthExponent < -128 || DepthExponent > 127 || SlopeExponent < -128 || SlopeExponent > 127) begin : g_refused_10
    an_exponent_does_not_fit_8_bits u_refused ();
  end
  if (value(Config, PitchNmField) < 0) begin : g_refused_11
    PitchNm_must_not_be_negative u_refused ();
  end

`ifndef SYNTHESIS
  // synthesis translate_off
  initial begin : g_tables
    string fault;
    fault = td_tables_pkg::fault(TableFolder, value(Config, TablesCrcField));
    if (fault != "") $fatal(1, "%0s", fault);
  end
  // synthesis translate_on
`endif

endmodule

`default_nettype wire
