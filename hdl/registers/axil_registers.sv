// SPDX-License-Identifier: Apache-2.0
// axil_registers: the registers of the pipeline, on AXI4-Lite.
//
//   s_axil <-> axil_port -> setting_registers -> thresholds, settings
//                        -> event_registers   <- events, irq
//                        -> table_banks      <-> banks, captures
//                        -> table_access     <-> entries of the tables
//                        -> table_signatures  <- captures
//
// The map is docs/generated/registers.md. A write takes effect, unless it is refused, in the cycle in which axil_port
// raises `write`; a read shows the registers as they were before the write of the same cycle. An event counts for each
// cycle in which it is high, and reaches status and counters one cycle later. Word n of the record of contact is in
// bits 32 n + 31 to 32 n, and is read as it stands.
// Model: models/tactile_depth/chip/registers/axil_registers.py.

`default_nettype none

module axil_registers
  import td_config_pkg::*;
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter SignatureFile = "",  // of the tables at power-up: table_signatures.sv
  parameter logic [ConfigBits-1:0] Config = DefaultConfig,
  localparam int Tridiagonal      = value(Config, TridiagonalField),
  localparam int Neumann          = value(Config, NeumannField),
  localparam int Rows             = value(Config, RowsField),
  localparam int Columns          = value(Config, ColumnsField),
  localparam int DataWidth        = value(Config, DataWidthField),
  localparam int GradientWidth    = value(Config, GradientWidthField),
  localparam int GradientFraction = value(Config, GradientFractionField),
  localparam int BitsPerChannel   = value(Config, BitsPerChannelField),
  localparam int FlatField        = value(Config, FlatFieldField),
  localparam int Polynomial       = value(Config, PolynomialField),
  localparam int Corrections      = value(Config, CorrectionsField),
  localparam int LightGains       = value(Config, LightGainsField),
  localparam int ZeroOffset       = value(Config, ZeroOffsetField),
  localparam int Lanes            = value(Config, LanesField),
  localparam int BlockLog2        = value(Config, BlockLog2Field),
  localparam int GainWidth        = value(Config, GainWidthField),
  localparam int DepthMantissa    = value(Config, DepthMantissaField),
  localparam int DepthExponent    = value(Config, DepthExponentField),
  localparam int SlopeMantissa    = value(Config, SlopeMantissaField),
  localparam int SlopeExponent    = value(Config, SlopeExponentField),
  localparam int PitchNm          = value(Config, PitchNmField),
  localparam int ResidualBound    = value(Config, ResidualBoundField),
  localparam int Camera           = value(Config, CameraField)
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       cold_rst,  // clears the banks of the tables, together with rst

  input  wire  [AddressWidth-1:0]   s_axil_awaddr,
  input  wire  [2:0]                s_axil_awprot,  // no effect
  input  wire                       s_axil_awvalid,
  output logic                      s_axil_awready,
  input  wire  [31:0]               s_axil_wdata,
  input  wire  [3:0]                s_axil_wstrb,
  input  wire                       s_axil_wvalid,
  output logic                      s_axil_wready,
  output logic [1:0]                s_axil_bresp,
  output logic                      s_axil_bvalid,
  input  wire                       s_axil_bready,
  input  wire  [AddressWidth-1:0]   s_axil_araddr,
  input  wire  [2:0]                s_axil_arprot,  // no effect
  input  wire                       s_axil_arvalid,
  output logic                      s_axil_arready,
  output logic [31:0]               s_axil_rdata,
  output logic [1:0]                s_axil_rresp,
  output logic                      s_axil_rvalid,
  input  wire                       s_axil_rready,
  output logic                      irq,

  input  wire events_t              events,
  input  wire levels_t              levels,
  input  wire  [31:0]               first_depth_latency,
  input  wire                       first_depth_latency_valid,
  input  wire  [32*RecordWords-1:0] record,

  output contact_settings_t         contact_settings,
  output logic [31:0]               timeout,
  output logic                      self_test,  // for the clock of the write
  output logic [7:0]                dark_level,
  output logic [7:0]                slope_limit,
  output light_command_t            light_command,
  input  wire  [2:0][LightGainWidth-1:0] light_gains,  // ignored without LightGains

  input  wire                       frame_start,  // the first pixel of a frame passes the head of the pipeline
  output table_command_t            table_command,
  input  wire table_answer_t        table_answer,
  output logic [3:0]                table_bank,
  input  wire  [3:0]                table_in_use,
  output capture_command_t          reference_command,
  input  wire capture_status_t      reference_status,
  output capture_command_t          zero_command,
  input  wire capture_status_t      zero_status,
  output register_command_t         register_command,  // to the registers of camera_unit
  input  wire register_answer_t     register_answer    // ignored without Camera
);

  localparam int GradientWords = Polynomial != 0 && Corrections == 0 ? 0 : 1 << (3 * BitsPerChannel);
  localparam int CoefficientWords = Polynomial != 0 ? PolynomialWords : 0;
  localparam int Nodes = nodes(Rows, Columns, BlockLog2);
  localparam int ReferenceWords = FlatField != 0 ? 4 * Nodes : 0;
  localparam int ZeroWords = ZeroOffset != 0 ? Nodes : 0;
  localparam int Present = (int'(GradientWords != 0) << TableSelectGradient)
    | (int'(CoefficientWords != 0) << TableSelectCoefficients)
    | (int'(ReferenceWords != 0) << TableSelectReference) | (int'(ZeroWords != 0) << TableSelectZero);
  localparam logic [31:0] GridWord = (Rows << GridRowsLsb) | (Columns << GridColumnsLsb);
  localparam logic [31:0] FormatWord = (DataWidth << FormatDataWidthLsb) | (GradientWidth << FormatGradientWidthLsb)
    | (GradientFraction << FormatGradientFractionLsb)
    | ((GradientWords != 0 ? BitsPerChannel : 0) << FormatBitsPerChannelLsb);
  localparam logic [31:0] DeviceWord = DeviceReset | (Tridiagonal << DeviceSolverBit) | (Neumann << DeviceBoundaryBit)
    | (Polynomial << DeviceGradientModelBit) | (FlatField << DeviceFlatFieldBit) | (ZeroOffset << DeviceZeroOffsetBit)
    | (LightGains << DeviceLightGainsBit) | (Lanes << DeviceLanesLsb)
    | ((FlatField != 0 ? GainWidth : 0) << DeviceGainWidthLsb);
  localparam logic [31:0] DepthUnitWord =
    (DepthMantissa << DepthUnitMantissaLsb) | (DepthExponent << DepthUnitExponentLsb);
  localparam logic [31:0] SlopeUnitWord =
    (SlopeMantissa << SlopeUnitMantissaLsb) | (SlopeExponent << SlopeUnitExponentLsb);

  logic write, entry_refused, capture_refused, read, read_refused, read_late, late_refused;
  logic [31:0] write_offset, write_ones, write_mask, late_data;
  logic [3:0][31:0] read_offset;  // copies: of settings; of events and banks; of what is read here; of all others
  logic [8:0][31:0] read_data;  // each that of a source
  wire [31:0] own_offset = read_offset[2];
  wire register_answer_t camera_answer = Camera != 0 ? register_answer : '0;
  assign register_command = {write && !rst, write_offset, write_ones, write_mask, read_offset[3]};
  axil_port #(.Sources(9), .Copies(4)) u_port (
    .clk, .rst, .s_axil_awaddr, .s_axil_awvalid, .s_axil_awready, .s_axil_wdata, .s_axil_wstrb, .s_axil_wvalid,
    .s_axil_wready, .s_axil_bresp, .s_axil_bvalid, .s_axil_bready, .s_axil_araddr, .s_axil_arvalid, .s_axil_arready,
    .s_axil_rdata, .s_axil_rresp, .s_axil_rvalid, .s_axil_rready, .write, .write_offset, .write_ones, .write_mask,
    .write_refused(!(is_writable(write_offset) || camera_answer.writable) || entry_refused || capture_refused),
    .read, .read_offset, .read_data, .read_refused, .read_late, .late_data, .late_refused
  );

  logic [31:0] setting_data, event_data, bank_data, entry_data, signature_data;
  logic [Settings-1:0][31:0] settings;
  setting_registers #(
    .Resets(SettingResets | ((32 * Settings)'($unsigned(PitchNm)) << (32 * PitchSetting)))
  ) u_settings (
    .clk, .rst, .write(write && !capture_refused), .write_offset, .write_ones, .write_mask,
    .read_offset(read_offset[0]), .read_data(setting_data), .settings
  );
  assign contact_settings.threshold = settings[ThresholdSetting];
  assign contact_settings.off_threshold = settings[OffThresholdSetting];
  assign contact_settings.area_threshold = settings[AreaThresholdSetting];
  assign contact_settings.minimum_area = settings[MinimumAreaSetting];
  assign contact_settings.debounce = settings[DebounceSetting][7:0];
  assign contact_settings.hold_contact = settings[ControlSetting][ControlHoldContactBit];
  assign contact_settings.drop_frames = settings[ControlSetting][ControlDropFramesBit];
  assign timeout = settings[TimeoutSetting];
  assign self_test = write && write_offset == ControlOffset && write_ones[ControlSelfTestBit] && !rst;
  assign dark_level = settings[DarkLevelSetting][7:0];
  assign slope_limit = settings[SlopeLimitSetting][7:0];

  // Light gains, which light_gains holds; a write replaces the bytes that are strobed.

  logic [2:0] gain_writes;
  logic [2:0][31:0] light_offsets;
  logic [LightGainWidth-1:0] gain_before, gain_read;
  assign light_offsets = {32'(LightGainBlueOffset), 32'(LightGainGreenOffset), 32'(LightGainRedOffset)};
  assign light_command.follow = settings[LightSetting][LightFollowBit];
  assign light_command.rate = settings[LightSetting][LightRateLsb+:3];
  assign light_command.write = gain_writes;
  assign light_command.gain = write_ones[LightGainWidth-1:0] | (gain_before & ~write_mask[LightGainWidth-1:0]);
  always_comb begin
    {gain_before, gain_read} = '0;
    for (int c = 0; c < 3; c++) begin
      gain_writes[c] = write && write_offset == light_offsets[c] && !rst;
      if (write_offset == light_offsets[c]) gain_before = light_gains[c];
      if (LightGains != 0 && own_offset == light_offsets[c]) gain_read = light_gains[c];
    end
  end

  events_t events_q;  // so that no path from the pipeline ends in the logic of the counters
  always_ff @(posedge clk) events_q <= rst ? '0 : events;
  event_registers u_events (
    .clk, .rst, .write, .write_offset, .write_ones, .read_offset(read_offset[1]), .read_data(event_data),
    .events(events_q), .levels, .first_depth_latency, .first_depth_latency_valid,
    .interrupt_mask(settings[InterruptMaskSetting]), .irq
  );

  logic [3:0] closed;
  logic reference_request, zero_request;
  table_banks #(.Present(Present)) u_banks (
    .clk, .rst, .cold_rst, .write, .write_offset, .write_ones, .write_refused(capture_refused),
    .read_offset(read_offset[1]), .read_data(bank_data), .frame_start, .table_bank, .table_in_use, .closed,
    .reference_request, .reference_status, .zero_request, .zero_status
  );
  assign reference_command.request = reference_request;
  assign reference_command.log2_frames = settings[ReferenceCaptureSetting][ReferenceCaptureLog2FramesLsb+:4];
  assign zero_command.request = zero_request;
  assign zero_command.log2_frames = settings[ZeroCaptureSetting][ZeroCaptureLog2FramesLsb+:4];

  table_access #(
    .GradientWords(GradientWords), .CoefficientWords(CoefficientWords), .ReferenceWords(ReferenceWords),
    .ZeroWords(ZeroWords)
  ) u_access (
    .clk, .rst, .write, .write_offset, .write_ones, .write_mask, .write_refused(entry_refused),
    .read, .read_offset(read_offset[3]), .read_data(entry_data), .read_late, .late_data, .late_refused,
    .select(settings[TableSelectSetting][TableSelectSelectLsb+:TableSelectSelectWidth]), .closed, .table_command,
    .table_answer
  );

  table_signatures #(.File(SignatureFile), .Side(side(Lanes, BlockLog2))) u_signatures (
    .clk, .rst, .cold_rst, .write, .write_offset, .write_mask, .read_offset(read_offset[3]), .read_data(signature_data),
    .table_command, .table_in_use, .reference_captured(reference_status.captured), .zero_captured(zero_status.captured)
  );

  localparam logic [31:0] ArithmeticWord = arithmetic(Config);

  // Words of the record: the offsets of its registers differ modulo 128.

  logic is_record;
  logic [31:0] record_word;
  logic [31:0][31:0] record_at;
  assign record_word = is_record ? record_at[own_offset[6:2]] : '0;
  always_comb begin
    is_record = 1'b0;
    record_at = '0;
    for (int n = 0; n < RecordWords; n++) begin
      is_record = is_record | (own_offset == RecordOffsets[32*n+:32]);
      record_at[RecordOffsets[32*n+2+:5]] = record[32*n+:32];
    end
  end

  logic [31:0] word;  // that no core above holds
  always_comb
    case (own_offset)
      IdOffset: word = IdReset;
      GridOffset: word = GridWord;
      FormatOffset: word = FormatWord;
      DeviceOffset: word = DeviceWord;
      DepthUnitOffset: word = DepthUnitWord;
      ResidualBoundOffset: word = ResidualBound;
      SlopeUnitOffset: word = SlopeUnitWord;
      ArithmeticOffset: word = ArithmeticWord;
      default: word = '0;
    endcase
  assign read_data = {
    word, record_word, signature_data, 32'(gain_read), setting_data, event_data, bank_data, entry_data,
    camera_answer.data
  };
  assign read_refused = !(is_register(own_offset) || camera_answer.readable);

endmodule

`default_nettype wire
