// SPDX-License-Identifier: Apache-2.0
// td_types_pkg: types of the side-band between units and of the buses of tables and registers, and functions.
//
// Members are unsigned and of fixed width: Icarus 11 takes no others.

`default_nettype none

package td_types_pkg;

  // The position of a pixel, or of its slopes, in the frame.
  typedef struct packed {
    logic last_column;
    logic last_row;
    logic first_column;
    logic first_row;
  } position_t;

  // Faults of a frame on s_axis, each for one cycle: hdl/video/frame_guard.sv.
  typedef struct packed {
    logic timed_out;
    logic start_early;
    logic start_missing;
    logic row_long;
    logic row_short;
  } faults_t;

  // Settings of hdl/camera/camera_front_end.sv, for the next picture: its size, the first pixel of the window, black
  // level and gains of the colours; a gain has 12 fraction bits.
  typedef struct packed {
    logic [12:0] columns;
    logic [12:0] rows;
    logic [12:0] window_x;
    logic [12:0] window_y;
    logic [11:0] black_level;
    logic [15:0] red_gain;
    logic [15:0] green_gain;
    logic [15:0] blue_gain;
  } camera_settings_t;

  // Faults of a camera's picture, each for one cycle: hdl/camera/camera_window.sv.
  typedef struct packed {
    logic window_outside;
    logic start_early;
    logic start_missing;
    logic row_long;
    logic row_short;
  } camera_faults_t;

  // What CAMERA_STATUS and CAMERA_ARRIVED show as it is.
  typedef struct packed {
    logic        hunting;  // words are dropped up to the next start of picture
    logic        waiting;  // no word has come since the reset
    logic [13:0] arrived_columns;
    logic [13:0] arrived_rows;
  } camera_levels_t;

  // The position of a depth value in its frame, in the order in which depth leaves.
  typedef struct packed {
    logic frame_start;
    logic row_end;
    logic frame_end;
  } depth_position_t;

  // How far the depth of a frame holds: words 12 to 14 of its record, as docs/generated/registers.md has them.
  typedef struct packed {
    logic [15:0] steep;             // pixels
    logic [15:0] dark;              // pixels
    logic [15:0] light_gain_blue;   // 15 fraction bits; 0 without light gains
    logic [15:0] light_gain_green;
    logic [15:0] light_gain_red;
    logic [8:0]  others;            // 0
    logic        residual;
    logic        flipped;
    logic        resumed;
    logic        light_moves;
    logic        zero_clipped;
    logic        depth_clipped;
    logic        colours_clipped;
  } frame_flags_t;

  // What the units report to the register file; each bit for one cycle.
  typedef struct packed {
    faults_t     faults;
    logic        out_of_step;    // depth was not where it was due
    logic        frame_in;       // a whole, good frame came in
    logic        frame_out;      // a frame has left
    logic        dark;           // a pixel was held from its neighbour
    logic        depth_dropped;  // a depth frame was given up
    logic        record_lost;
    logic        record_valid;   // the record of contact is new
    logic        flipped;        // a word with a flipped bit was read from a memory
    logic        residual;       // the record is of a frame whose residual is beyond its bound
    logic [13:0] saturations;    // values clipped: up to 8 bits of them for each of 64 depths a cycle
  } events_t;

  // What STATUS, ARRIVED and SELF_TEST show as it is.
  typedef struct packed {
    logic        busy;      // a frame is in flight
    logic        contact;
    logic        touching;
    logic        hunting;   // pixels are dropped up to the next start of frame
    logic        stalled;   // the sink of depth holds the pipeline up, or has cost a frame
    logic [13:0] arrived_columns;  // of the row that ended last
    logic [13:0] arrived_rows;     // of the frame that ended last
    logic [31:0] self_test;        // signature of the last self-test, 0 without
    logic [31:0] residual;         // of the frame whose record is new
  } levels_t;

  // From the register file to every table. A table obeys `write` and `read` if `select` names it. Beside this bus,
  // table_bank and table_in_use have a bit for each table, by its number in TABLE_SELECT.
  typedef struct packed {
    logic        write;   // the entry `index` becomes {high, low}
    logic        read;
    logic [1:0]  select;  // TABLE_SELECT
    logic [23:0] index;
    logic [31:0] high;
    logic [31:0] low;
  } table_command_t;

  // The entry that was read. A table that `select` does not name answers zero; the answers are combined by OR.
  typedef struct packed {
    logic [31:0] high;
    logic [31:0] low;
  } table_answer_t;

  // From the AXI4-Lite port to registers beside those of tactile_depth, which is all that they need to know of an
  // access.
  typedef struct packed {
    logic        write;
    logic [31:0] write_offset;  // of the register, in bytes
    logic [31:0] write_ones;    // the data, 0 in bytes without strobe
    logic [31:0] write_mask;    // ones in bytes with strobe
    logic [31:0] read_offset;
  } register_command_t;

  // Their answer, in the same cycle.
  typedef struct packed {
    logic        writable;  // the register at write_offset is one of them, and takes writes
    logic        readable;  // the register at read_offset is one of them
    logic [31:0] data;      // its word; zero for any other
  } register_answer_t;

  // A capture: of the reference frame, or of the zero offset.
  typedef struct packed {
    logic       request;
    logic [3:0] log2_frames;
  } capture_command_t;

  // What a capture writes into its free bank, and the words by which hdl/registers/table_signatures.sv knows it.
  typedef struct packed {
    logic        writes;  // a word of the bank changes
    logic        starts;  // a run of all its entries begins, before the first of its steps
    logic        steps;   // `word` is that of the next entry, or the signature from 0 of the next entries
    logic        ends;    // with the last of the steps
    logic [31:0] word;    // sign-extended; 0 without a step
  } captured_t;

  typedef struct packed {
    logic      busy;
    logic      done;
    captured_t captured;
  } capture_status_t;

  // From the registers to the light gains. Colours: red, green, blue from the lowest bit.
  typedef struct packed {
    logic        follow;
    logic [2:0]  rate;
    logic [2:0]  write;  // the gain of this colour becomes `gain`
    logic [15:0] gain;   // 15 fraction bits
  } light_command_t;

  // What the registers say of contact. Thresholds are signed depth codes.
  typedef struct packed {
    logic [31:0] threshold;
    logic [31:0] off_threshold;
    logic [31:0] area_threshold;
    logic [31:0] minimum_area;
    logic [7:0]  debounce;
    logic        hold_contact;
    logic        drop_frames;
  } contact_settings_t;

  // Sums of the depths above a threshold in a frame. Without any the limits have no meaning, and the others are 0. Rows
  // are counted from the top of the picture.
  typedef struct packed {
    logic [31:0] area;           // pixels
    logic [63:0] weight;         // what the depths are above the threshold
    logic [63:0] row_moment;     // of the weights, from the last row to come
    logic [63:0] column_moment;  // of the weights, from the last column
    logic [15:0] greatest_row;
    logic [15:0] greatest_column;
    logic [15:0] least_row;
    logic [15:0] least_column;
  } contact_sums_t;

  // A counter that counts on, and stays at all ones; or begins again. A clearing write comes late, behind the sum.
  localparam int StepWidth = 14;
  function automatic logic [31:0] counted(
    input logic [31:0] count, input logic [StepWidth-1:0] step, input logic clear
  );
    logic [32:0] sum;
    sum = {1'b0, count} + 33'(step);
    counted = clear ? 32'(step) : sum[31:0] | {32{sum[32]}};
  endfunction

  // The signature of words, which starts with all ones, and of one word more: a multiple-input signature register.
  function automatic logic [31:0] signature_step(input logic [31:0] last, input logic [31:0] word);
    signature_step = (last >> 1) ^ (last[0] ? td_link_pkg::CrcPolynomial : 32'd0) ^ word;
  endfunction

  // The register ARITHMETIC: the signature of the numbers of a configuration that depth of a picture depends on. Icarus
  // takes no loop that declares its variable here.
  function automatic logic [31:0] arithmetic(input logic [td_config_pkg::ConfigBits-1:0] config_word);
    int n;
    logic [31:0] signature;
    signature = '1;
    for (n = 0; n < td_config_pkg::ConfigBits / 32; n = n + 1) begin
      if (td_config_pkg::ArithmeticFields[n]) signature = signature_step(signature, config_word[32*n+:32]);
    end
    arithmetic = signature;
  endfunction

  // Nodes of a map: one for each complete block of pixels.
  function automatic int nodes(input int rows, input int columns, input int block_log2);
    nodes = (rows / (1 << block_log2)) * (columns / (1 << block_log2));
  endfunction

  // Nodes side by side that a capture of several lanes writes at once.
  function automatic int side(input int lanes, input int block_log2);
    side = lanes > 1 << block_log2 ? lanes / (1 << block_log2) : 1;
  endfunction

  // A threshold that fits one bit more than depths of `width` bits have; beyond those of depths it stays beyond them.
  function automatic logic signed [31:0] near_depths(input logic signed [31:0] code, input int width);
    logic [31:0] low, word;
    low = (32'd1 << (width - 1)) - 32'd1;
    word = $unsigned(code);
    near_depths = $signed((low & word) | (~low & {32{word[31]}}));
    near_depths[width-1] = word[31] ? &(word | low) : |(word & ~low);
  endfunction

endpackage

`default_nettype wire
