// SPDX-License-Identifier: Apache-2.0
// frame_marks: how far the slopes of a frame hold: clips, dark pixels, steep pixels, and the light gains in force.
//
//   steep = the upper 8 bits of |gx| or of |gy|, without their sign, are above slope_limit; a negative slope counts as
//           one code less than it is
//
// Three stages are looked at: colours relative to the reference, in the light of the reference, and slopes. The last
// pixel of a frame is at a stage while its `_ends` is high; what counts comes for one cycle, enabled or not, from the
// first cycle of a pixel at its stage on. A count stays at all ones. Frames follow one another without a gap; each is
// at no stage before the frame before it has left the next. Stream out: out_valid with the flags of each frame, those
// of the solver and of the zero offset 0. Latency: 1 cycle from slope_ends. Model:
// models/tactile_depth/chip/gradient/frame_marks.py.

`default_nettype none

module frame_marks
  import td_types_pkg::*;
#(
  parameter int Width     = 21,     // of a slope
  parameter int Pixels    = 16384,  // of a frame
  parameter int CountBits = 16,     // of a count, at most
  localparam int GainWidth = 16
) (
  input  wire                       clk,
  input  wire                       rst,
  input  wire                       en,
  input  wire  [7:0]                slope_limit,

  input  wire                       relative_ends,
  input  wire                       relative_clipped,  // a value was, for one cycle
  input  wire                       dark,              // a pixel is, for one cycle
  input  wire  [2:0][GainWidth-1:0] light_gains,       // with relative_ends, of the frame that ends
  input  wire                       light_moves,       // the same
  input  wire                       colour_ends,
  input  wire                       colour_clipped,
  input  wire                       slope_valid,
  input  wire                       slope_ends,
  input  wire                       slope_clipped,
  input  wire  signed [Width-1:0]   slope_gx,          // slope code
  input  wire  signed [Width-1:0]   slope_gy,          // slope code
  input  wire                       resumed,           // with out_valid, of that frame

  output logic                      out_valid,
  output frame_flags_t              out_flags
);

  localparam int Most = (1 << CountBits) - 1;
  localparam int CountWidth = Pixels < Most ? $clog2(Pixels + 1) : CountBits;

  // A clip of a stage, in this frame and, from the end of the frame on, in the last.

  logic [2:0] clips, ends, clipped, clipped_now, last_clipped;
  assign clips = {slope_clipped, colour_clipped, relative_clipped};
  assign ends = {slope_ends, colour_ends, relative_ends};
  assign clipped_now = clipped | clips;
  for (genvar stage = 0; stage < 3; stage++) begin : g_stage
    always_ff @(posedge clk) begin
      clipped[stage] <= clipped_now[stage];
      if (en && ends[stage]) last_clipped[stage] <= clipped_now[stage];
      if (rst || (en && ends[stage])) clipped[stage] <= 1'b0;
    end
  end

  // Pixels. A steep one counts a cycle late.

  logic [1:0] steep;  // along each axis
  logic [1:0][7:0] steepness;
  logic [1:0][CountWidth-1:0] counts, counts_now;  // dark, steep
  logic [1:0] pixels, pixels_end;
  assign pixels = {|steep, dark};
  assign pixels_end = {out_valid, relative_ends};
  for (genvar axis = 0; axis < 2; axis++) begin : g_axis
    logic [Width-1:0] slope;
    assign slope = axis == 0 ? slope_gx : slope_gy;
    assign steepness[axis] = 8'({slope[Width-2:0] ^ {(Width - 1) {slope[Width-1]}}, 8'd0} >> (Width - 1));
  end
  for (genvar n = 0; n < 2; n++) begin : g_count
    logic full;
    assign full = Pixels > Most && counts[n] == '1;
    assign counts_now[n] = counts[n] + CountWidth'(pixels[n] && !full);
    always_ff @(posedge clk) begin
      counts[n] <= counts_now[n];
      if (rst || (en && pixels_end[n])) counts[n] <= '0;
    end
  end

  logic moves;
  logic [CountWidth-1:0] dark_count;
  logic [2:0][GainWidth-1:0] gains;
  always_ff @(posedge clk) begin
    for (int n = 0; n < 2; n++) steep[n] <= en & slope_valid & steepness[n] > slope_limit;
    if (en) out_valid <= slope_ends;
    if (en && relative_ends) begin
      {gains, moves} <= {light_gains, light_moves};
      dark_count <= counts_now[0];
    end
    if (rst) {steep, out_valid} <= '0;
  end

  assign out_flags.colours_clipped = |last_clipped;
  assign {out_flags.others, out_flags.residual, out_flags.flipped} = '0;
  assign {out_flags.zero_clipped, out_flags.depth_clipped} = '0;
  assign out_flags.light_moves = moves;
  assign out_flags.resumed = resumed;
  assign {out_flags.light_gain_blue, out_flags.light_gain_green, out_flags.light_gain_red} = gains;
  assign out_flags.dark = 16'(dark_count);
  assign out_flags.steep = 16'(counts_now[1]);

endmodule

`default_nettype wire
