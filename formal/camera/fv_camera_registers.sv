// SPDX-License-Identifier: Apache-2.0
// fv_camera_registers: each register as docs/generated/camera-registers.md has it, and the outputs that
// show the settings.
//
// Nothing is assumed of the port, the front end, the set-up or reset.

parameter int PictureColumns = 13'h1555, PictureRows = 13'h0AAA, WindowX = 13'h1234, WindowY = 13'h0765,
    BlackLevel = 12'hABC, RedGain = 16'h1357, GreenGain = 16'h2468, BlueGain = 16'hFEDC;
localparam int Phase = 2;

localparam logic [31:0] FormatWord = 32'h00000a26;  // RAW10, GBRG, 10 bits
localparam logic [31:0] WindowSizeWord = 32'h01e001e0;

// The write of this clock, and what a register becomes by it.
logic [31:0] written_at, ones, mask;
always_comb assume ((write_ones & ~write_mask) == '0);
assign written_at = write ? write_offset : 32'hffffffff;
assign ones = write_ones;
assign mask = write_mask;
function automatic logic [31:0] becomes(input int offset, input logic [31:0] word, input logic [31:0] bits);
  return written_at == 32'(offset) ? ((word & ~mask) | (ones & mask)) & bits : word;
endfunction
function automatic logic [31:0] counts_on(input logic [31:0] count, input int more);
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
  picture <= becomes(CameraPictureOffset, picture, 32'h1fff1fff);
  window <= becomes(CameraWindowOffset, window, 32'h1fff1fff);
  black <= becomes(CameraBlackLevelOffset, black, 32'hfff);
  red <= becomes(CameraRedGainOffset, red, 32'hffff);
  green <= becomes(CameraGreenGainOffset, green, 32'hffff);
  blue <= becomes(CameraBlueGainOffset, blue, 32'hffff);
  seen <= {faults.window_outside, faults.start_early, faults.start_missing, faults.row_long, faults.row_short};
  given_up <= frames_lost;
  sticky <= (written_at == CameraStatusOffset ? sticky & ~(ones & mask) : sticky) | 32'({given_up != '0, seen});
  dropped <= counts_on(clears ? '0 : dropped, seen != '0 ? 1 : 0);
  lost <= counts_on(clears ? '0 : lost, 32'(given_up));
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
logic known;
always_comb begin
  known = 1'b1;
  case (read_offset)
    CameraPictureOffset: word = picture;
    CameraWindowOffset: word = window;
    CameraWindowSizeOffset: word = WindowSizeWord;
    CameraFormatOffset: word = FormatWord;
    CameraBlackLevelOffset: word = black;
    CameraRedGainOffset: word = red;
    CameraGreenGainOffset: word = green;
    CameraBlueGainOffset: word = blue;
    CameraStatusOffset: word = sticky | 32'({levels.waiting, levels.hunting, setup_failed, setup_done, 8'd0});
    CameraControlOffset: word = '0;
    CameraDroppedOffset: word = dropped;
    CameraLostOffset: word = lost;
    CameraArrivedOffset: word = {16'(levels.arrived_rows), 16'(levels.arrived_columns)};
    CameraSetupOffset: word = 32'({setup_found, setup_entry});
    default: begin
      word = '0;
      known = 1'b0;
    end
  endcase
end
function automatic logic known_write(input logic [31:0] offset);
  return offset == CameraPictureOffset || offset == CameraWindowOffset || offset == CameraBlackLevelOffset
      || offset == CameraRedGainOffset || offset == CameraGreenGainOffset || offset == CameraBlueGainOffset
      || offset == CameraStatusOffset || offset == CameraControlOffset;
endfunction

always_comb begin
  if (started) begin
    its_word: assert (read_data == word);
    its_register: assert (readable == known);
    takes_writes: assert (writable == known_write(write_offset));
    restart: assert (setup_restart == (written_at == CameraControlOffset && ones[1] && mask[1]));
    picture_size: assert (32'(settings.columns) == 32'(picture[12:0]) && 32'(settings.rows) == picture >> 16);
    window_place: assert (32'(settings.window_x) == 32'(window[12:0]) && 32'(settings.window_y) == window >> 16);
    colours: assert (32'(settings.black_level) == black && 32'(settings.red_gain) == red
        && 32'(settings.green_gain) == green && 32'(settings.blue_gain) == blue);
    set_wins: cover (written_at == CameraStatusOffset && ones[1] && seen[1] && sticky[1]);
    kept: cover (clears && dropped == 32'd1 && seen != '0 && given_up == 8'd3);
    gain_read: cover (read_data == 32'h00004321 && read_offset == CameraGreenGainOffset);
  end
end
