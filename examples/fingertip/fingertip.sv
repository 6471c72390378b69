// SPDX-License-Identifier: Apache-2.0
// fingertip: a small design around a wrapper of tactile_depth: pixels in, the deepest code of each frame out.
//
// `deepest` holds the largest depth code of the last whole frame; `deepest_valid` is high for a clock when it changes.
// Records and registers are not used. tb_fingertip.sv is its testbench; docs/integrate.md shows how to run it.

`default_nettype none

module fingertip (
  input  wire                clk,
  input  wire                rst,
  input  wire         [23:0] pixel,
  input  wire                pixel_valid,
  output logic               pixel_ready,
  input  wire                row_end,
  input  wire                frame_start,
  output logic signed [23:0] deepest,
  output logic               deepest_valid
);

  localparam int Rows = 8;  // of the configuration of tactile_depth_finger

  logic [23:0] depth;
  logic depth_valid, depth_row_end, depth_frame_start;
  logic [31:0] record_word, register_word;
  logic [8:0] marks;
  logic [1:0] write_response, read_response;
  logic unused;
  assign unused = ^{record_word, register_word, marks, write_response, read_response};

  tactile_depth_finger u_finger (
    .clk, .rst, .cold_rst(1'b0),
    .s_axis_tdata(pixel), .s_axis_tvalid(pixel_valid), .s_axis_tready(pixel_ready),
    .s_axis_tlast(row_end), .s_axis_tuser(frame_start),
    .m_axis_tdata(depth), .m_axis_tvalid(depth_valid), .m_axis_tready(1'b1), .m_axis_tlast(depth_row_end),
    .m_axis_tuser(depth_frame_start), .contact(marks[0]), .irq(marks[8]),
    .m_event_tdata(record_word), .m_event_tvalid(marks[1]), .m_event_tready(1'b1), .m_event_tlast(marks[2]),
    .s_axil_awaddr(10'd0), .s_axil_awprot(3'd0), .s_axil_awvalid(1'b0), .s_axil_awready(marks[3]),
    .s_axil_wdata(32'd0), .s_axil_wstrb(4'd0), .s_axil_wvalid(1'b0), .s_axil_wready(marks[4]),
    .s_axil_bresp(write_response), .s_axil_bvalid(marks[5]), .s_axil_bready(1'b1),
    .s_axil_araddr(10'd0), .s_axil_arprot(3'd0), .s_axil_arvalid(1'b0), .s_axil_arready(marks[6]),
    .s_axil_rdata(register_word), .s_axil_rresp(read_response), .s_axil_rvalid(marks[7]), .s_axil_rready(1'b1)
  );

  logic signed [23:0] largest, larger;
  logic [$clog2(Rows)-1:0] row;
  assign larger = depth_frame_start || $signed(depth) > largest ? $signed(depth) : largest;
  always_ff @(posedge clk) begin
    deepest_valid <= 1'b0;
    if (depth_valid) begin
      largest <= larger;
      if (depth_frame_start) row <= '0;
      if (depth_row_end) row <= row + 1'b1;
      if (depth_row_end && row == ($clog2(Rows))'(Rows - 1)) begin
        deepest <= larger;
        deepest_valid <= 1'b1;
      end
    end
    if (rst) deepest_valid <= 1'b0;
  end

endmodule

`default_nettype wire
