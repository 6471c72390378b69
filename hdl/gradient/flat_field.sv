// SPDX-License-Identifier: Apache-2.0
// flat_field: colours relative to the reference frame, by the gains of td_node_map; dark pixels held from their
// neighbour.
//
//   out = sat( round( I gain / 2^Drop ) - Offset )       of red, green and blue
//
// With Offset 0 these are codes, unsigned (128 I / ref); else deviations, signed (I / ref - 1). A pixel is dark if all
// its colours are under dark_level, as it stood when the frame's first pixel came, or if the gain of one of them has
// its top bit set. It takes over what left for the pixel before it in its row, the first of a row Flat; `dark` is high
// one cycle for each. Nothing that a dark pixel would clip counts as saturation.
// Stream in: pixels R in 23:16, B in 15:8, G in 7:0. Stream out: colours relative to the reference.
// Latency: 13 cycles. Table port: docs/streams.md; a gain is at index 4 node + channel: red 0, green 1, blue 2.
// Bit-accurate model: models/tactile_depth/chip/gradient/flat_field.py.

`default_nettype none

module flat_field
  import td_register_map_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter int Rows      = 128,
  parameter int Columns   = 128,
  parameter int BlockLog2 = 3,
  parameter int GainWidth = 24,
  parameter int Drop      = 20,
  parameter int Offset    = 0,  // even: it is subtracted before rounding to even
  parameter int OutWidth  = 8,
  parameter int Flat      = 128,
  parameter int Parity    = 0,  // 1: a parity bit in each word of a memory
  localparam int NodeWidth = $clog2(nodes(Rows, Columns, BlockLog2))
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    en,
  input  wire  [7:0]             dark_level,

  input  wire table_command_t    table_command,
  output table_answer_t          table_answer,
  input  wire                    table_bank,
  output logic                   table_in_use,

  input  wire                    capture_write,
  input  wire  [NodeWidth-1:0]   capture_write_node,
  input  wire  [3*GainWidth-1:0] capture_gains,
  input  wire                    capture_read,
  input  wire  [NodeWidth-1:0]   capture_read_node,
  output logic [3*GainWidth-1:0] capture_read_gains,

  input  wire                    in_valid,
  input  wire  [23:0]            in_pixel,    // three codes of 8 bits
  input  wire position_t         in_position,
  output logic                   out_valid,
  output position_t              out_position,
  output logic [OutWidth-1:0]    out_red,     // code, or deviation, signed, where Offset is not 0
  output logic [OutWidth-1:0]    out_green,
  output logic [OutWidth-1:0]    out_blue,
  output logic                   dark,
  output logic [1:0]             saturations,  // clip count, delayed
  output logic                   flipped      // a word that was read, or a gain, has a flipped bit
);

  localparam int DataWidth = 1 + $bits(position_t) + 24;  // of what waits for the gains
  localparam int Stored = DataWidth + Parity;             // with `dim` twice: it comes too late for a parity
  localparam int ToOut = 2;  // stages between the gain and the output
  localparam int ProductWidth = 8 + GainWidth + 2;  // of two signs more
  localparam int RoundedWidth = OutWidth + (Offset == 0 ? 1 : 0);  // td_round_saturate is signed

  // Colours in the order of the gains: red, green, blue from the lowest.

  logic frame_start, dim_in, dim, gain_valid, map_flipped;
  logic [7:0] red, green, blue, level, level_q;
  logic [2:0][7:0] colours;
  position_t gain_position;
  logic [Stored-1:0] late;
  logic [2:0][GainWidth-1:0] gains;
  assign {red, blue, green} = in_pixel;
  assign frame_start = in_position.first_row & in_position.first_column;
  assign level = frame_start ? dark_level : level_q;
  assign dim_in = red < level & green < level & blue < level;
  assign {dim, gain_position, colours} = late[DataWidth-1:0];
  td_node_map #(
    .Name({TableFolder, "gain"}), .Rows(Rows), .Columns(Columns), .BlockLog2(BlockLog2), .Width(GainWidth),
    .Channels(3), .DataWidth(Stored), .Select(TableSelectReference), .Parity(Parity), .Checked(DataWidth - 1)
  ) u_map (
    .clk, .rst, .en, .table_command, .table_answer, .table_bank, .table_in_use,
    .capture_write, .capture_write_node, .capture_words(capture_gains),
    .capture_read, .capture_read_node, .capture_read_words(capture_read_gains),
    .in_valid, .in_frame_start(frame_start), .in_data(Stored'({dim_in, dim_in, in_position, blue, green, red})),
    .out_valid(gain_valid), .out_data(late), .out_words(gains), .active(),
    .flipped(map_flipped)
  );
  if (Parity == 0) begin : g_plain
    assign flipped = map_flipped;
  end else begin : g_check  // gains come from the table alone
    logic differs, dim_flipped;
    assign flipped = map_flipped | differs | dim_flipped;
    always_ff @(posedge clk) dim_flipped <= late[DataWidth] ^ dim;
    td_repeat_check #(.Width(3 * GainWidth)) u_repeat (
      .clk, .rst, .en, .in_valid(gain_valid), .in_first(gain_position.first_row & gain_position.first_column),
      .in_last(gain_position.last_row & gain_position.last_column), .in_bank(table_in_use), .in_data(gains), .differs
    );
  end

  logic dead;
  logic [ToOut-1:0] valid_q, dark_q;
  position_t [ToOut-1:0] position_q;
  logic [2:0] clipped;
  assign dead = gains[0][GainWidth-1] | gains[1][GainWidth-1] | gains[2][GainWidth-1];

  logic [2:0][OutWidth-1:0] out;
  assign {out_blue, out_green, out_red} = out;
  for (genvar c = 0; c < 3; c++) begin : g_channel
    logic signed [ProductWidth-1:0] product, sum;
    td_multiply #(.AWidth(GainWidth + 1), .BWidth(9)) u_product (
      .clk, .en, .a({1'b0, gains[c]}), .b({1'b0, colours[c]}), .product
    );
    logic signed [RoundedWidth-1:0] rounded;
    td_round_saturate #(.InWidth(ProductWidth), .Drop(Drop), .OutWidth(RoundedWidth)) u_round (
      .in(sum), .out(rounded), .clipped(clipped[c])
    );
    always_ff @(posedge clk) begin
      if (en) begin
        sum <= product - (ProductWidth'(Offset) <<< Drop);
        if (valid_q[1] & ~dark_q[1]) out[c] <= rounded[OutWidth-1:0];
        else if (valid_q[1] & position_q[1].first_column) out[c] <= OutWidth'(Flat);
      end
    end
  end

  always_ff @(posedge clk) begin
    if (en) begin
      if (in_valid) level_q <= level;
      valid_q <= {valid_q[0], gain_valid};
      position_q <= {position_q[0], gain_position};
      dark_q <= {dark_q[0], dim | dead};
      out_valid <= valid_q[1];
      out_position <= position_q[1];
    end
    dark <= en & valid_q[1] & dark_q[1];
    saturations <= en & valid_q[1] & ~dark_q[1] ? 2'(clipped[0]) + 2'(clipped[1]) + 2'(clipped[2]) : '0;
    if (rst) {valid_q, out_valid, dark, saturations} <= '0;
  end

endmodule

`default_nettype wire
