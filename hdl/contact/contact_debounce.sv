// SPDX-License-Identifier: Apache-2.0
// contact_debounce: touching or not, decided once a frame from the area of the contact.
//
//   touching <- 1 after `debounce` frames in a row with area >= minimum_area (debounce 0 counts as 1)
//   touching <- 0 after `debounce` frames in a row with a smaller area
//
// Settings are those of the frame whose area is valid. A minimum_area of 0 makes every frame one that touches.
// Latency: touching_next follows area in the same cycle; touching, began and ended 1 cycle later. Bit-accurate model:
// models/tactile_depth/chip/contact/contact_debounce.py.

`default_nettype none

module contact_debounce #(
  parameter int AreaWidth = 15
) (
  input  wire                  clk,
  input  wire                  rst,
  input  wire                  area_valid,     // once a frame
  input  wire  [AreaWidth-1:0] area,           // pixels
  input  wire  [31:0]          minimum_area,   // pixels
  input  wire  [7:0]           debounce,       // frames
  output logic                 touching_next,  // value of `touching` in the next cycle
  output logic                 touching,
  output logic                 began,          // touching rose with the last frame
  output logic                 ended           // touching fell with the last frame
);

  logic differs, changes;
  logic [7:0] differing_frames;  // in a row, before this one, whose area speaks against `touching`
  assign differs = (32'(area) >= minimum_area) != touching;
  assign changes = differs & (9'(differing_frames) + 9'd1 >= 9'(debounce));
  assign touching_next = touching ^ (area_valid & changes);

  always_ff @(posedge clk) begin
    touching <= touching_next;
    if (area_valid) begin
      began <= changes & ~touching;
      ended <= changes & touching;
      differing_frames <= differs & ~changes ? differing_frames + 8'd1 : 8'd0;
    end
    if (rst) begin
      touching <= 1'b0;
      differing_frames <= '0;
    end
  end

endmodule

`default_nettype wire
