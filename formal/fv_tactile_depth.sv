// SPDX-License-Identifier: Apache-2.0
// fv_tactile_depth: no handshake and no side-band depends on the state at power-up.
//
// Two pipelines start from any state, each its own, memories included; one clock of reset, then the same inputs for ever, whatever
// they are. What the bus and the streams show of them is always the same, but for data.

module fv_tactile_depth
  import register_map_pkg::*;
#(
  parameter int Tridiagonal  = 1,
  parameter int Rows         = 2,
  parameter int Size         = 8,
  parameter int FrameLatency = 81
) (
  input logic                    clk,
  input logic                    rst,
  input logic [23:0]             s_axis_tdata,
  input logic                    s_axis_tvalid,
  input logic                    s_axis_tlast,
  input logic                    s_axis_tuser,
  input logic                    m_axis_tready,
  input logic [AddressWidth-1:0] s_axil_awaddr,
  input logic                    s_axil_awvalid,
  input logic [31:0]             s_axil_wdata,
  input logic [3:0]              s_axil_wstrb,
  input logic                    s_axil_wvalid,
  input logic                    s_axil_bready,
  input logic [AddressWidth-1:0] s_axil_araddr,
  input logic                    s_axil_arvalid,
  input logic                    s_axil_rready
);

  logic started = 1'b0;
  always_comb if (!started) assume (rst);
  always_ff @(posedge clk) started <= 1'b1;

  logic [1:0] s_axis_tready, m_axis_tvalid, m_axis_tlast, m_axis_tuser, contact, awready, wready, bvalid, arready, rvalid;
  logic [1:0] bresp[2], rresp[2];
  logic [31:0] rdata[2];
  logic [7:0] depth[2];
  for (genvar i = 0; i < 2; i++) begin : g_copy
    tactile_depth #(
      .Tridiagonal(Tridiagonal), .Rows(Rows), .Size(Size), .FrameLatency(FrameLatency), .BitsPerChannel(1),
      .GradientWidth(3), .GradientFraction(2), .DataWidth(4), .Width(5), .CoeffWidth(3), .RowForwardOut(0),
      .ColumnForwardIn(0), .ColumnInverseOut(0), .RowInverseIn(0), .RowInverseOut(0), .DivideShiftWidth(1),
      .DivideDrop(2), .StoreDrop(1), .TableWords(16), .SettledWidth(1), .LastShiftWidth(1)
    ) dut (
      .clk, .rst, .s_axis_tdata, .s_axis_tvalid, .s_axis_tready(s_axis_tready[i]), .s_axis_tlast, .s_axis_tuser,
      .m_axis_tdata(depth[i]), .m_axis_tvalid(m_axis_tvalid[i]), .m_axis_tready, .m_axis_tlast(m_axis_tlast[i]),
      .m_axis_tuser(m_axis_tuser[i]), .contact(contact[i]),
      .s_axil_awaddr, .s_axil_awvalid, .s_axil_awready(awready[i]), .s_axil_wdata, .s_axil_wstrb, .s_axil_wvalid,
      .s_axil_wready(wready[i]), .s_axil_bresp(bresp[i]), .s_axil_bvalid(bvalid[i]), .s_axil_bready,
      .s_axil_araddr, .s_axil_arvalid, .s_axil_arready(arready[i]), .s_axil_rdata(rdata[i]), .s_axil_rresp(rresp[i]),
      .s_axil_rvalid(rvalid[i]), .s_axil_rready
    );
  end

  always_comb begin
    if (started) begin
      source_side: assert (s_axis_tready[0] == s_axis_tready[1]);
      sink_side: assert (m_axis_tvalid[0] == m_axis_tvalid[1]);
      if (m_axis_tvalid[0]) side_bands: assert (m_axis_tlast[0] == m_axis_tlast[1] && m_axis_tuser[0] == m_axis_tuser[1]);
      bus: assert (awready[0] == awready[1] && wready[0] == wready[1] && bvalid[0] == bvalid[1]
          && arready[0] == arready[1] && rvalid[0] == rvalid[1]);
      if (bvalid[0]) responses: assert (bresp[0] == bresp[1]);
      pixel_taken: cover (s_axis_tready[0] && s_axis_tvalid && s_axis_tuser);
    end
  end

endmodule
