// SPDX-License-Identifier: Apache-2.0
// fv_flat_field: what leaves for a pixel is round(I gain / 2^Drop) - Offset, saturated, with the gain that td_node_map has
// for it; a dark pixel takes over what left before it in its row, the first of a row Flat; dark ones and clipped
// colours are counted once. Valid and place travel along, 13 enabled clocks; while en is low they hold.
//
// In two parts, which share what stands beside each other when the gains come. Meets 1: that is an arbitrary pixel's
// own colours, valid and place, 10 enabled clocks after it came. Meets 0: whatever stands there, what leaves is right.
// Assumed: places in raster order; of each colour the lowest bits alone differ from zero (products of any width are
// exact).

parameter int Meets = 0, Rows = 3, Columns = 4, GainWidth = 3, Drop = 2, Offset = 0, OutWidth = 1, Flat = 1;
localparam int BlockLog2 = 1;
input logic choose;  // the pixel that is followed

assign capture_write = 1'b0;
assign capture_write_node = '0;
assign capture_gains = '0;
assign capture_read = 1'b0;
assign capture_read_node = '0;

// Pixels in raster order, as the protocol has them; what it asks of the table these properties do not need.
logic [3:0] place;
raster_places #(.Rows(Rows), .Columns(Columns)) u_places (.*, .reset(rst), .row(), .column());
assign allowed = !in_valid || in_position == place;
always_comb assume ((in_pixel & ~24'h010101) == '0);

if (Meets != 0) begin : g_meets
  localparam int ToGain = 10;

  logic [7:0] level, level_now;
  logic [3:0] age, place;  // enabled clocks since the pixel came
  logic follows;
  logic [24:0] pixel;
  always_comb level_now = in_position[1:0] == 2'b11 ? dark_level : level;
  always_ff @(posedge clk) begin
    if (en) begin
      if (in_valid) level <= level_now;
      age <= age + 4'd1;
      if (age == 4'(ToGain)) follows <= 1'b0;
      if (choose && !follows && in_valid) begin
        follows <= 1'b1;
        age <= 4'd1;
        place <= in_position;
        pixel <= {in_pixel[23:16] < level_now && in_pixel[15:8] < level_now && in_pixel[7:0] < level_now,
            in_pixel[15:8], in_pixel[7:0], in_pixel[23:16]};
      end
    end
    if (rst || !started) follows <= 1'b0;
  end
  always_comb begin
    if (started && follows && age == 4'(ToGain)) begin
      valid_meets: assert (dut.gain_valid);
      place_meets: assert (dut.gain_position == place);
      pixel_meets: assert ({dut.dim, dut.colours} == pixel);
    end
    meets_dim: cover (started && follows && age == 4'(ToGain) && dut.dim && dut.colours[0][0]);
    meets_bright: cover (started && follows && age == 4'(ToGain) && !dut.dim && place[1:0] == 2'b01);
  end
end else begin : g_leaves
  localparam int ToOut = 3, Lowest = Offset == 0 ? 0 : -(1 << (OutWidth - 1)),
      Highest = Offset == 0 ? (1 << OutWidth) - 1 : (1 << (OutWidth - 1)) - 1;

  logic signed [GainWidth+9:0] result[3];
  logic [2:0] clips;
  logic is_dark;
  always_comb begin
    assume ((dut.colours & ~24'h010101) == '0);
    is_dark = dut.dim || dut.gains[0][GainWidth-1] || dut.gains[1][GainWidth-1] || dut.gains[2][GainWidth-1];
    for (int c = 0; c < 3; c++) begin
      logic [GainWidth-1:0] product, whole;
      product = dut.colours[c][0] ? dut.gains[c] : '0;
      whole = product >> Drop;
      if (product[Drop-1] && (Drop > 1 && (product & GainWidth'((1 << (Drop - 1)) - 1)) != '0 || whole[0])) begin
        result[c] = $signed((GainWidth + 10)'(whole)) + 1 - Offset;
      end else begin
        result[c] = $signed((GainWidth + 10)'(whole)) - Offset;
      end
      clips[c] = result[c] < Lowest || result[c] > Highest;
      if (result[c] < Lowest) result[c] = (GainWidth + 10)'(Lowest);
      if (result[c] > Highest) result[c] = (GainWidth + 10)'(Highest);
    end
  end

  logic [ToOut-1:0] valid;
  logic [4*ToOut-1:0] place;
  logic [1:0] dark_q;
  logic [5:0] clips_q;
  logic [6*OutWidth-1:0] results_q;
  logic [3*OutWidth-1:0] expected, out_q;  // {blue, green, red}
  logic expected_dark, held, known;
  logic [1:0] expected_clips;
  always_ff @(posedge clk) begin
    held <= ~en & ~rst;
    out_q <= {out_blue, out_green, out_red};
    expected_dark <= en && !rst && valid[ToOut-2] && dark_q[1];
    expected_clips <= en && !rst && valid[ToOut-2] && !dark_q[1]
        ? 2'(clips_q[3]) + 2'(clips_q[4]) + 2'(clips_q[5]) : '0;
    if (en) begin
      valid <= {valid[ToOut-2:0], dut.gain_valid};
      place <= {place[4*ToOut-5:0], dut.gain_position};
      dark_q <= {dark_q[0], is_dark};
      clips_q <= {clips_q[2:0], clips};
      results_q <= {results_q[3*OutWidth-1:0], OutWidth'(result[2]), OutWidth'(result[1]), OutWidth'(result[0])};
      if (valid[ToOut-2] && (!dark_q[1] || place[4*ToOut-7])) begin
        known <= 1'b1;
        expected <= dark_q[1] ? {3{OutWidth'(Flat)}} : results_q[6*OutWidth-1-:3*OutWidth];
      end
    end
    if (rst) begin
      valid <= '0;
      known <= 1'b0;
    end
  end

  always_comb begin
    if (started) begin
      valid_travels: assert (out_valid == valid[ToOut-1]);
      if (out_valid) place_travels: assert (out_position == place[4*ToOut-1-:4]);
      if (out_valid && known) colours_follow: assert ({out_blue, out_green, out_red} == expected);
      if (held) holds: assert ({out_blue, out_green, out_red} == out_q);
      dark_counted: assert (dark == expected_dark);
      clipped_counted: assert (saturations == expected_clips);
      several_dark: cover (dark && !out_position[1] && out_red == '0 && out_valid);
      clipped: cover (saturations == 2'd2);
    end
  end
end
