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
// it would swing. A frame uses the gains as they stood when its first pixel came, and moves them as its last pixel
// comes, if `follow` is high and `in_bad` was not. `write` of a colour replaces its gain by write_gain, and wins; less
// than 1/2 counts as 1/2. `moves`, with a frame's last pixel: a gain moves by more than 1/32, or by 1/32 down.
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
  parameter int OutFraction   = 15
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
  output logic [1:0]                  saturations  // clip count, delayed
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
  localparam int MoveWidth = GainWidth + 1;
  localparam int QuietLog2 = 5;  // -log2 of the move from which the gains do not fit the light
  localparam int QuietWidth = GainFraction > QuietLog2 ? GainFraction - QuietLog2 : 0;  // bits of a smaller one
  localparam logic [GainWidth-1:0] One = GainWidth'(1) << GainFraction;
  localparam logic signed [MoveWidth-1:0] Step = MoveWidth'(1 << (GainFraction - NearLog2));

  // A frame: from its first pixel to its last.

  logic in_frame, bad, ends, commits, free;
  assign ends = in_valid & in_position.last_row & in_position.last_column;
  assign commits = en & ends & follow & ~bad & ~in_bad;
  assign free = en & in_valid ? ends : ~in_frame;  // the next pixel is the first of a frame
  always_ff @(posedge clk) begin
    if (en & in_valid) in_frame <= ~ends;
    if (en) bad <= (bad | in_bad) & ~ends;
    if (rst) {in_frame, bad} <= '0;
  end

  // Pixels, 2 cycles; then they are counted.

  logic valid_q, blank_q, counts, restart;
  position_t position_q;
  logic [2:0] clipped;
  logic [2:0][RatioWidth-1:0] ratios;
  logic [2:0][OutWidth-1:0] deviations, out;
  assign ratios = {in_blue, in_green, in_red};
  assign {out_blue, out_green, out_red} = out;
  always_ff @(posedge clk) begin
    if (en) begin
      {out_valid, valid_q} <= {valid_q, in_valid};
      {out_position, position_q} <= {position_q, in_position};
      blank_q <= ratios == '0;
      counts <= out_valid & ~out_position.last_row;
      restart <= out_position.first_row & out_position.first_column;
    end
    saturations <= en & valid_q & ~blank_q ? 2'(clipped[0]) + 2'(clipped[1]) + 2'(clipped[2]) : '0;
    if (rst) {out_valid, valid_q, counts, saturations} <= '0;
  end

  // Pixels without contact, and whether they are enough.

  logic [2:0] above, below, moves_far;
  logic [CountWidth-1:0] near_count;
  logic near_enough;
  always_ff @(posedge clk) begin
    if (en & counts) near_count <= (restart ? '0 : near_count) + CountWidth'({above, below} == '0);
    near_enough <= {near_count, 2'b00} >= (CountWidth + 2)'($unsigned(Pixels));
  end

  assign moves = |moves_far;
  for (genvar c = 0; c < 3; c++) begin : g_colour
    logic signed [ProductWidth-1:0] product, difference;
    td_multiply #(.AWidth(RatioWidth + 1), .BWidth(GainWidth + 1)) u_product (
      .clk, .en, .a({1'b0, ratios[c]}), .b({1'b0, used[c]}), .product
    );
    assign difference = product - (ProductWidth'(1) <<< (RatioFraction + GainFraction));
    logic signed [OutWidth-1:0] counted_deviation;
    td_round_saturate #(.InWidth(ProductWidth), .Drop(Drop), .OutWidth(OutWidth)) u_deviation (
      .in(difference), .out(deviations[c]), .clipped(clipped[c])
    );

    logic signed [CountWidth:0] net;  // pixels above less pixels below
    logic signed [SumWidth-1:0] sum, slowed;
    logic up, down;
    logic signed [MoveWidth-1:0] mean, move, moved;
    logic [GainWidth-1:0] kept, chosen, next;
    td_round_saturate #(.InWidth(SumWidth), .Drop(SumDrop), .OutWidth(MoveWidth)) u_mean (
      .in(slowed), .out(mean), .clipped()
    );
    assign moved = $signed({1'b0, gains[c]}) - move;
    assign moves_far[c] = move[MoveWidth-1:QuietWidth] != {(MoveWidth - QuietWidth) {move[MoveWidth-1]}};
    assign kept = moved[GainWidth] ? '1 : moved[GainWidth-1:0];  // no move takes a gain of 1/2 below 0
    assign chosen = write[c] ? write_gain : commits ? kept : gains[c];
    logic [3:0] slow;
    assign slow = {1'b0, rate} + 4'(used[c] < One - GainWidth'(Step));
    assign next = chosen[GainWidth-1-:2] == '0 ? One >> 1 : chosen;
    always_ff @(posedge clk) begin
      if (en) begin
        out[c] <= blank_q ? '0 : deviations[c];
        counted_deviation <= $signed(out[c]);
        above[c] <= $signed(out[c]) >= OutWidth'(Near);
        below[c] <= $signed(out[c]) <= -OutWidth'(Near);
        if (counts) begin
          net <= (restart ? '0 : net) + (CountWidth + 1)'(above[c]) - (CountWidth + 1)'(below[c]);
          sum <= (restart ? '0 : sum) + ({above, below} == '0 ? SumWidth'(counted_deviation) : '0);
        end
      end
      slowed <= sum >>> slow;
      up <= 8 * (CountWidth + 4)'(net) <= -(CountWidth + 4)'(3 * Pixels);
      down <= 8 * (CountWidth + 4)'(net) >= (CountWidth + 4)'(3 * Pixels);
      move <= up ? -Step : down ? Step : near_enough ? mean : '0;
      gains[c] <= next;
      if (free) used[c] <= next;
      if (rst) begin
        gains[c] <= One;
        used[c] <= One;
      end
    end
  end

endmodule

`default_nettype wire
