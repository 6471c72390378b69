// SPDX-License-Identifier: Apache-2.0
// light_gains: deviations of the colours from the reference, with the light of the reference: one gain for each colour.
//
//   out = sat( round( ratio gain - 1 ) )       of red, green and blue; 0 where all three ratios are 0
//
// The gains follow the light where nothing touches. Of a frame's N pixels, its last row left out:
//
//   8 |pixels with out >= 1/8 less those with out <= -1/8| >= 3 N  the light of this colour stepped: gain -+ 1/8
//   else 4 (pixels with all |out| < 1/8) >= N                      gain - round( sum of their out >> slow / 2^SumLog2 )
//   else                                                           a large contact: the gain is held
//
// and 1/2 <= gain < 2; slow is rate, and 1 more if the frame used a gain below 7/8: in more light a gain moves less, or
// it would swing. A frame uses gains and rate as they stood when its first pixel came, and moves the gains as its last
// pixel comes, if `follow` is high and `in_bad` was not. `write` of a colour replaces its gain by write_gain, and wins;
// less than 1/2 counts as 1/2. `moves`, with a frame's last pixel: a gain moves by more than 1/32, or by 1/32 down. The
// move is computed while the last row comes, which has 10 pixels or more.
// Stream in: colours relative to the reference, raster order. Stream out: deviations, I gain / reference - 1.
// Latency: 2 cycles; a gap in, a gap out. Bit-accurate model: models/tactile_depth/chip/gradient/light_gains.py.

`default_nettype none

module light_gains
  import td_types_pkg::*;
#(
  parameter int Rows          = 128,
  parameter int Columns       = 128,
  parameter int RatioWidth    = 17,
  parameter int RatioFraction = 15,
  parameter int GainWidth     = 16,  // one bit less of them is fraction
  parameter int OutWidth      = 17,
  parameter int OutFraction   = 15,
  parameter int Parity        = 0    // 1: the gains have a parity
) (
  input  wire                         clk,
  input  wire                         rst,         // the gains become 1
  input  wire                         en,

  input  wire                         follow,
  input  wire  [2:0]                  rate,        // a frame moves a gain by its mean / 2^rate
  input  wire  [2:0]                  write,       // red, green, blue from the lowest, as in all that follows
  input  wire  [GainWidth-1:0]        write_gain,
  output logic [2:0][GainWidth-1:0]   gains,       // of the next frame
  output logic [2:0][GainWidth-1:0]   used,        // of this frame, with its pixels but the first
  output logic                        moves,

  input  wire                         in_bad,      // before or with a frame's last pixel: the frame was malformed
  input  wire                         in_valid,
  input  wire position_t              in_position,
  input  wire  [RatioWidth-1:0]       in_red,      // I / reference
  input  wire  [RatioWidth-1:0]       in_green,
  input  wire  [RatioWidth-1:0]       in_blue,
  output logic                        out_valid,
  output position_t                   out_position,
  output logic signed [OutWidth-1:0]  out_red,     // deviation, OutFraction bits
  output logic signed [OutWidth-1:0]  out_green,
  output logic signed [OutWidth-1:0]  out_blue,
  output logic [1:0]                  saturations, // clip count, delayed
  output logic                        flipped      // a gain has a flipped bit
);

  localparam int GainFraction = GainWidth - 1;
  localparam int Drop = RatioFraction + GainFraction - OutFraction;
  localparam int ProductWidth = RatioWidth + GainWidth + 2;  // of two signs more
  localparam int NearLog2 = 3;  // -log2 of the deviation from which a pixel may be contact, and of a step of a gain
  localparam int Near = 1 << (OutFraction - NearLog2);
  localparam int Pixels = (Rows - 1) * Columns;
  localparam int CountWidth = $clog2(Pixels + 1);
  localparam int SumWidth = OutFraction - NearLog2 + CountWidth + 1;
  localparam int SumLog2 = $clog2((2 * Pixels + 2) / 3);  // so that a gain moves by 3/16 to 3/2 of the mean
  localparam int SumDrop = SumLog2 + OutFraction - GainFraction;
  localparam int Colours = 3;
  localparam int FewLog2 = $clog2(Colours);  // of the pixels between two turns of a colour
  localparam int NearWidth = OutFraction - NearLog2 + 1;
  localparam int HighWidth = SumWidth - SumDrop + 1;  // of a sum: its mean, and one bit to round by
  localparam int MoveWidth = GainWidth + 1;
  localparam int QuietLog2 = 5;  // -log2 of the move from which the gains do not fit the light
  localparam int QuietWidth = GainFraction > QuietLog2 ? GainFraction - QuietLog2 : 0;  // bits of a smaller one
  localparam logic [GainWidth-1:0] One = GainWidth'(1) << GainFraction;
  localparam logic signed [MoveWidth-1:0] Step = MoveWidth'(1 << (GainFraction - NearLog2));

  // A frame: from its first pixel to its last.

  logic in_frame, bad, ends, commits, free;
  assign ends = in_valid & in_position.last_row & in_position.last_column;
  assign commits = en & ends & follow & ~bad & ~in_bad;
  assign free = rst | (en & in_valid ? ends : ~in_frame);  // the next pixel is the first of a frame
  always_ff @(posedge clk) begin
    if (en & in_valid) in_frame <= ~ends;
    if (en) bad <= (bad | in_bad) & ~ends;
    if (rst) {in_frame, bad} <= '0;
  end

  // Pixels, 2 cycles; then they are counted.

  logic valid_q, blank_q, begins, counts, is_near, near;
  position_t position_q;
  logic [Colours-1:0] clipped, above, below;
  logic [Colours-1:0][RatioWidth-1:0] ratios;
  logic [Colours-1:0][OutWidth-1:0] deviations, out;
  assign ratios = {in_blue, in_green, in_red};
  assign {out_blue, out_green, out_red} = out;
  assign begins = out_valid & out_position.first_row & out_position.first_column;
  assign counts = out_valid & ~out_position.last_row;
  assign is_near = counts & {above, below} == '0;
  always_ff @(posedge clk) begin
    if (en) begin
      {out_valid, valid_q} <= {valid_q, in_valid};
      {out_position, position_q} <= {position_q, in_position};
      blank_q <= ratios == '0;
      near <= is_near;
    end
    saturations <= en & valid_q & ~blank_q ? 2'(clipped[0]) + 2'(clipped[1]) + 2'(clipped[2]) : '0;
    if (rst) {out_valid, valid_q, saturations} <= '0;
  end

  // Pixels without contact, and whether they are enough.

  logic [CountWidth-1:0] near_count;
  logic near_enough;
  always_ff @(posedge clk) begin
    if (en) begin
      near_count <= begins ? '0 : near_count + CountWidth'(near);
      near_enough <= {near_count, 2'b00} >= (CountWidth + 2)'($unsigned(Pixels));
    end
  end

  // In turn a colour adds its few pixels since its last turn to its sum and to its pixels above less those below. These
  // go round: 2 clocks behind its turn they are in the lowest word. A frame's first pixel clears all.

  logic [Colours-1:0] turn, clears;  // one is high; of the words on top in the next clocks
  logic [Colours-1:0][NearWidth+FewLog2-1:0] few_sum;
  logic [Colours-1:0][FewLog2:0] few_net;
  logic signed [NearWidth+FewLog2-1:0] sum_in_turn;
  logic signed [FewLog2:0] net_in_turn;
  logic [Colours-1:0][SumWidth-1:0] sums;
  logic [Colours-1:0][CountWidth:0] nets;
  always_ff @(posedge clk) begin
    if (en) begin
      turn <= {turn[1:0], turn[1:0] == '0};  // one is high again if a flip made it none or two
      clears <= {clears[1:0], begins};
      sum_in_turn <= $signed(turn[0] ? few_sum[0] : turn[1] ? few_sum[1] : few_sum[2]);
      net_in_turn <= $signed(turn[0] ? few_net[0] : turn[1] ? few_net[1] : few_net[2]);
      sums <= {clears != '0 ? SumWidth'(0) : sums[1], sums[0], sums[2] + SumWidth'(sum_in_turn)};
      nets <= {clears != '0 ? (CountWidth + 1)'(0) : nets[1], nets[0], nets[2] + (CountWidth + 1)'(net_in_turn)};
    end
    if (rst) turn <= Colours'(1);
  end

  // Its move: the sum without its lowest `slow` bits is rounded by the bit below the mean, and whether others are 1.

  logic [Colours-1:0] slower, moves_far;
  logic [2:0] rate_q;
  logic [3:0] slow, slow_q;
  logic [1:0] slow_qq;  // a quarter of it
  logic [SumWidth-1:0] sum, from_slow;  // the bits that stay
  logic signed [HighWidth-1:0] high, high_q, high_qq;
  logic rest_q, rest_qq, up_q, up_qq, down_q, down_qq;
  logic signed [MoveWidth-1:0] mean, move;
  assign slow = 4'(rate_q) + 4'((turn & {slower[1:0], slower[2]}) != '0);
  td_round_saturate #(.InWidth(HighWidth + 1), .Drop(2), .OutWidth(MoveWidth)) u_mean (
    .in($signed({high_qq, rest_qq})), .out(mean), .clipped()
  );
  assign sum = sums[0];
  assign high = sum[SumWidth-1-:HighWidth];
  assign move = up_qq ? -Step : down_qq ? Step : near_enough ? mean : '0;
  assign moves = moves_far != '0;
  always_ff @(posedge clk) begin
    if (free) rate_q <= rate;
    if (en) begin
      {slow_qq, slow_q} <= {slow_q[3:2], slow};
      from_slow <= '1 << slow;
      rest_q <= (sum & from_slow & ~(from_slow << (SumDrop - 1))) != '0;
      high_q <= high >>> slow_q[1:0];
      high_qq <= high_q >>> {slow_qq, 2'b00};
      up_q <= 8 * (CountWidth + 4)'($signed(nets[0])) <= -(CountWidth + 4)'(3 * Pixels);
      down_q <= 8 * (CountWidth + 4)'($signed(nets[0])) >= (CountWidth + 4)'(3 * Pixels);
      {rest_qq, up_qq, down_qq} <= {rest_q, up_q, down_q};
    end
  end

  // A gain that is wrong would stay so: a frame moves it by a fraction of what it is off.
  if (Parity == 0) begin : g_plain
    assign flipped = 1'b0;
  end else begin : g_parity
    logic gains_flipped, used_flipped;
    assign flipped = gains_flipped | used_flipped;
    td_hold_check #(.Width(Colours * GainWidth)) u_gains (
      .clk, .rst, .comes(rst | commits | write != '0), .word(gains), .flipped(gains_flipped)
    );
    td_hold_check #(.Width(Colours * GainWidth)) u_used (
      .clk, .rst, .comes(free), .word(used), .flipped(used_flipped)
    );
  end

  logic [GainWidth-1:0] least_write;
  assign least_write = write_gain[GainWidth-1-:2] == '0 ? One >> 1 : write_gain;
  for (genvar c = 0; c < Colours; c++) begin : g_colour
    logic signed [ProductWidth-1:0] product, difference;
    td_multiply #(.AWidth(RatioWidth + 1), .BWidth(GainWidth + 1)) u_product (
      .clk, .en, .a({1'b0, ratios[c]}), .b({1'b0, used[c]}), .product
    );
    assign difference = product - (ProductWidth'(1) <<< (RatioFraction + GainFraction));
    td_round_saturate #(.InWidth(ProductWidth), .Drop(Drop), .OutWidth(OutWidth)) u_deviation (
      .in(difference), .out(deviations[c]), .clipped(clipped[c])
    );
    assign above[c] = $signed(out[c]) >= OutWidth'(Near);
    assign below[c] = $signed(out[c]) <= -OutWidth'(Near);

    logic signed [NearWidth-1:0] near_deviation;
    logic is_above, is_below;
    logic [NearWidth+FewLog2-1:0] few_sum_q;
    logic [FewLog2:0] few_net_q;
    assign few_sum[c] = few_sum_q + (NearWidth + FewLog2)'(near_deviation);
    assign few_net[c] = few_net_q + (FewLog2 + 1)'(is_above) - (FewLog2 + 1)'(is_below);

    logic signed [MoveWidth-1:0] move_q, moved;
    logic [GainWidth-1:0] kept, next;
    logic sets;
    assign moved = $signed({1'b0, gains[c]}) - move_q;  // no move takes a gain of 1/2 below 0
    assign kept = moved[GainWidth] ? '1 : moved[GainWidth-1-:2] == '0 ? One >> 1 : moved[GainWidth-1:0];
    assign sets = write[c] | commits;
    assign next = write[c] ? least_write : kept;
    always_ff @(posedge clk) begin
      slower[c] <= used[c] < One - GainWidth'(Step);
      if (en) begin
        out[c] <= blank_q ? '0 : deviations[c];
        near_deviation <= is_near ? NearWidth'(out[c]) : '0;
        {is_above, is_below} <= counts ? {above[c], below[c]} : '0;
        {few_sum_q, few_net_q} <= turn[c] | begins ? '0 : {few_sum[c], few_net[c]};
        if (turn[(c+4)%Colours]) begin
          move_q <= move;
          moves_far[c] <= move[MoveWidth-1:QuietWidth] != {(MoveWidth - QuietWidth) {move[MoveWidth-1]}};
        end
      end
      if (sets) gains[c] <= next;
      if (free) used[c] <= sets ? next : gains[c];
      if (rst) begin
        gains[c] <= One;
        used[c] <= One;
      end
    end
  end

endmodule

`default_nettype wire
