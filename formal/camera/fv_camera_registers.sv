// SPDX-License-Identifier: Apache-2.0
// fv_camera_registers: each register as docs/camera-registers.md has it, and the outputs that show the settings.
//
// Nothing is assumed of the master, the front end, the set-up or reset. axil_port is proven by itself: here the words
// and responses that it is given are those of the specification, and its writes are what the registers obey.

`default_nettype none

module fv_camera_registers
  import td_camera_map_pkg::*;
  import td_register_map_pkg::AddressWidth;
  import td_types_pkg::*;
#(
  parameter int PictureColumns = 13'h1555,
  parameter int PictureRows    = 13'h0AAA,
  parameter int WindowX        = 13'h1234,
  parameter int WindowY        = 13'h0765,
  parameter int BlackLevel     = 12'hABC,
  parameter int RedGain        = 16'h1357,
  parameter int GreenGain      = 16'h2468,
  parameter int BlueGain       = 16'hFEDC
) (
  input logic                    clk,
  input logic                    rst,
  input logic [AddressWidth-1:0] s_axil_awaddr,
  input logic [2:0]              s_axil_awprot,
  input logic                    s_axil_awvalid,
  input logic [31:0]             s_axil_wdata,
  input logic [3:0]              s_axil_wstrb,
  input logic                    s_axil_wvalid,
  input logic                    s_axil_bready,
  input logic [AddressWidth-1:0] s_axil_araddr,
  input logic [2:0]              s_axil_arprot,
  input logic                    s_axil_arvalid,
  input logic                    s_axil_rready,
  input camera_faults_t          faults,
  input logic [7:0]              frames_lost,
  input logic                    setup_done,
  input logic                    setup_failed,
  input logic [7:0]              setup_entry,
  input logic [7:0]              setup_found
);

  localparam logic [31:0] FormatWord = 32'h00000a20;  // RAW, GBRG, 10 bits
  localparam logic [31:0] WindowSizeWord = 32'h01e001e0;

  logic s_axil_awready, s_axil_wready, s_axil_bvalid, s_axil_arready, s_axil_rvalid, setup_restart;
  logic [1:0] s_axil_bresp, s_axil_rresp;
  logic [31:0] s_axil_rdata;
  camera_settings_t settings;
  camera_registers #(
    .PictureColumns(PictureColumns), .PictureRows(PictureRows), .WindowX(WindowX), .WindowY(WindowY),
    .BlackLevel(BlackLevel), .RedGain(RedGain), .GreenGain(GreenGain), .BlueGain(BlueGain), .Phase(2)
  ) dut (.*);

  logic started = 1'b0;
  always_comb if (!started) assume (rst);

  // The write of this clock, and what a register becomes by it.
  logic [31:0] written_at, ones, mask;
  assign written_at = dut.write ? dut.write_offset : 32'hffffffff;
  assign ones = dut.write_ones;
  assign mask = dut.write_mask;
  function automatic logic [31:0] becomes(input int offset, input logic [31:0] word, input logic [31:0] bits);
    return written_at == 32'(offset) ? ((word & ~mask) | (ones & mask)) & bits : word;
  endfunction
  function automatic logic [31:0] counted(input logic [31:0] count, input int more);
    logic [33:0] sum;
    sum = 34'(count) + 34'(more);
    return sum > 34'hffffffff ? 32'hffffffff : 32'(sum);
  endfunction

  // The registers of the specification. Events of a clock reach them in the next, those of a clock in reset do not.
  logic [31:0] picture, window, black, red, green, blue, sticky, dropped, lost;
  logic [4:0] seen;  // faults
  logic [7:0] given_up;
  logic clears;
  assign clears = written_at == CameraControlOffset & ones[0] & mask[0];
  always_ff @(posedge clk) begin
    started <= 1'b1;
    picture <= becomes(CameraPictureOffset, picture, 32'h1fff1fff);
    window <= becomes(CameraWindowOffset, window, 32'h1fff1fff);
    black <= becomes(CameraBlackLevelOffset, black, 32'hfff);
    red <= becomes(CameraRedGainOffset, red, 32'hffff);
    green <= becomes(CameraGreenGainOffset, green, 32'hffff);
    blue <= becomes(CameraBlueGainOffset, blue, 32'hffff);
    seen <= {faults.window_outside, faults.start_early, faults.start_missing, faults.row_long, faults.row_short};
    given_up <= frames_lost;
    sticky <= (written_at == CameraStatusOffset ? sticky & ~(ones & mask) : sticky) | 32'({given_up != '0, seen});
    dropped <= counted(clears ? '0 : dropped, seen != '0 ? 1 : 0);
    lost <= counted(clears ? '0 : lost, 32'(given_up));
    if (rst) begin
      picture <= 32'(PictureRows * 65536 + PictureColumns);
      window <= 32'(WindowY * 65536 + WindowX);
      black <= BlackLevel;
      red <= RedGain;
      green <= GreenGain;
      blue <= BlueGain;
      {seen, given_up, sticky, dropped, lost} <= '0;
    end
  end

  logic [31:0] word;
  logic known, writable;
  always_comb begin
    known = 1'b1;
    case (dut.read_offset)
      CameraPictureOffset: word = picture;
      CameraWindowOffset: word = window;
      CameraWindowSizeOffset: word = WindowSizeWord;
      CameraFormatOffset: word = FormatWord;
      CameraBlackLevelOffset: word = black;
      CameraRedGainOffset: word = red;
      CameraGreenGainOffset: word = green;
      CameraBlueGainOffset: word = blue;
      CameraStatusOffset: word = sticky | 32'({setup_failed, setup_done, 8'd0});
      CameraControlOffset: word = '0;
      CameraDroppedOffset: word = dropped;
      CameraLostOffset: word = lost;
      CameraSetupOffset: word = 32'({setup_found, setup_entry});
      default: begin
        word = '0;
        known = 1'b0;
      end
    endcase
    writable = known_write(dut.write_offset);
  end
  function automatic logic known_write(input logic [31:0] offset);
    return offset == CameraPictureOffset || offset == CameraWindowOffset || offset == CameraBlackLevelOffset
        || offset == CameraRedGainOffset || offset == CameraGreenGainOffset || offset == CameraBlueGainOffset
        || offset == CameraStatusOffset || offset == CameraControlOffset;
  endfunction

  // What a read shall return in the next clock.
  logic [31:0] word_q;
  logic known_q, read_q, write_q, writable_q;
  always_ff @(posedge clk) begin
    {word_q, known_q, read_q} <= {word, known, dut.read};
    {write_q, writable_q} <= {dut.write, writable};
  end

  always_comb begin
    if (started) begin
      if (dut.read) its_word: assert (dut.read_data == word);
      if (read_q) its_answer: assert (s_axil_rvalid && s_axil_rdata == word_q
          && s_axil_rresp == (known_q ? 2'd0 : 2'd2));
      if (write_q) its_response: assert (s_axil_bvalid && s_axil_bresp == (writable_q ? 2'd0 : 2'd2));
      restart: assert (setup_restart == (written_at == CameraControlOffset && ones[1] && mask[1]));
      picture_size: assert (32'(settings.columns) == 32'(picture[12:0]) && 32'(settings.rows) == picture >> 16);
      window_place: assert (32'(settings.window_x) == 32'(window[12:0]) && 32'(settings.window_y) == window >> 16);
      levels: assert (32'(settings.black_level) == black && 32'(settings.red_gain) == red
          && 32'(settings.green_gain) == green && 32'(settings.blue_gain) == blue);
      set_wins: cover (written_at == CameraStatusOffset && ones[1] && seen[1] && sticky[1]);
      kept: cover (clears && dropped == 32'd1 && seen != '0 && given_up == 8'd3);
      gain_read: cover (read_q && word_q == 32'h00004321 && known_q);
      refused: cover (write_q && !writable_q && s_axil_bvalid);
    end
  end

endmodule

`default_nettype wire
