// SPDX-License-Identifier: Apache-2.0
// nexus_solver: poisson_unit behind four pins, to measure its clock: the inputs are shifted in, the outputs out.
//
// Every pin of the unit is beside a register, so all paths of its clock are there. For commands/hardware/fpga.py.

`default_nettype none

module nexus_solver
  import td_config_pkg::*;
  import td_types_pkg::*;
#(
  parameter TableFolder = "./",  // of the .hex files, with a / at its end
  parameter logic [ConfigBits-1:0] Config = DefaultConfig
) (
  input  wire clk,
  input  wire load,       // take the outputs; they leave after it, the lowest bit first
  input  wire shift_in,
  output wire shift_out
);

  localparam int Lanes         = value(Config, LanesField);
  localparam int GradientWidth = value(Config, GradientWidthField);

  typedef struct packed {
    logic                            rst;
    logic                            en;
    logic                            valid;
    position_t                       position;
    logic signed [GradientWidth-1:0] gx;
    logic signed [GradientWidth-1:0] gy;
  } inputs_t;

  typedef struct packed {
    logic                                          burst_start;
    logic                                          frame_start;
    logic [Lanes*value(Config, DataWidthField)-1:0] depth;
    logic [7+$clog2(Lanes):0]                      saturations;
    logic                                          flipped;
    logic [31:0]                                   residual;
    logic                                          beyond;
  } outputs_t;

  inputs_t inputs;
  outputs_t outputs, taken;
  logic load_q;
  always_ff @(posedge clk) begin
    inputs <= {inputs[$bits(inputs_t)-2:0], shift_in};
    load_q <= load;
    taken <= load_q ? outputs : taken >> 1;
  end
  assign shift_out = taken[0];

  poisson_unit #(.TableFolder(TableFolder), .Config(Config)) u_poisson (
    .clk, .rst(inputs.rst), .en(inputs.en), .slope_valid(inputs.valid), .slope_position(inputs.position),
    .slope_gx(inputs.gx), .slope_gy(inputs.gy), .burst_start(outputs.burst_start),
    .depth_frame_start(outputs.frame_start), .depth_data(outputs.depth), .saturations(outputs.saturations),
    .flipped(outputs.flipped), .residual(outputs.residual), .beyond(outputs.beyond)
  );

endmodule

`default_nettype wire
