// SPDX-License-Identifier: Apache-2.0
// protocol_td_block_sum: frames in raster order, whole but for a reset, the first after a reset begins new sums; whatever
// the memory answers.

`default_nettype none

module protocol_td_block_sum #(
  parameter int Rows    = 128,
  parameter int Columns = 128
) (
  input  logic        clk,
  input  logic        rst,
  input  logic        in_valid,
  input  logic        in_frame_start,
  input  logic        in_first_frame,
  input  logic        read_en,
  input  logic        write_en,
  output logic        given_in_frame_start,
  output logic [15:0] row,
  output logic [15:0] column,
  output logic        holds,
  output logic        counts_read_block,
  output logic        counts_write_block,
  output logic        counts_write_sums,
  output logic        counts
);

  logic reset, live = 1'b0, begun = 1'b0;
  logic [3:0] place;
  assign reset = rst | ~holds;
  assign holds = rst | ~in_valid | begun | in_first_frame;
  always_ff @(posedge clk) begin
    live <= live | reset;
    begun <= ~reset & (begun | in_valid);
  end
  raster_places #(.Rows(Rows), .Columns(Columns)) u_places (.*, .en(1'b1));
  assign given_in_frame_start = in_valid & ~rst ? &place[1:0] : in_frame_start;
  assign counts = live & ~reset;
  assign counts_read_block = counts & read_en;
  assign {counts_write_block, counts_write_sums} = {2{counts & write_en}};

endmodule

`default_nettype wire
