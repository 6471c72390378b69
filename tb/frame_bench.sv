// SPDX-License-Identifier: Apache-2.0
// frame_bench: streams whole frames through tactile_depth without a coroutine step a pixel.
//
// frames.bin holds the frames of a sequence, three bytes a pixel (R, B, G, so that a word is tdata); depth.bin receives
// the codes that leave, four bytes each; events.txt one line per event: its letter and the clock.
//   p, l: first and last pixel of a frame taken       d, e: first and last depth of a frame on m_axis
//   c: first clock in which `contact` is up for the frame whose first depth has left
// Registers are reached through the AXI4-Lite ports. Simulation only.

module frame_bench
  import register_map_pkg::*;
#(
  parameter int Tridiagonal      = 0,
  parameter int Neumann          = 0,
  parameter int Rows             = 128,
  parameter int Size             = 128,
  parameter int BitsPerChannel   = 4,
  parameter int GradientWidth    = 21,
  parameter int GradientFraction = 20,
  parameter int DataWidth        = 24,
  parameter int Width            = 27,
  parameter int CoeffWidth       = 18,
  parameter int RowForwardOut    = 3,
  parameter int ColumnForwardIn  = 1,
  parameter int ColumnInverseOut = -1,
  parameter int RowInverseIn     = -3,
  parameter int RowInverseOut    = -1,
  parameter int DivideShiftWidth = 4,
  parameter int DivideDrop       = 23,
  parameter int StoreDrop        = 3,
  parameter int TableWords       = 1379,
  parameter int SettledWidth     = 7,
  parameter int LastShiftWidth   = 1,
  parameter int MomentDrop       = 7,
  parameter int MeanReciprocal   = 65536,
  parameter int MeanDrop         = 16,
  parameter int FrameLatency     = 17167
) (
  input  logic                    clk,
  input  logic                    rst,
  input  logic                    go,
  input  logic [31:0]             sequence_frames,  // frames in frames.bin
  input  logic [31:0]             total_frames,     // frames to send, the sequence over and over
  input  logic [31:0]             gap,              // probability of an idle input in a clock, of 2^32
  input  logic [31:0]             stall,            // probability of a refusing sink in a clock
  input  logic [31:0]             seed,             // not 0
  output logic                    done,
  output logic [31:0]             frames_received,

  input  logic [AddressWidth-1:0] s_axil_awaddr,
  input  logic                    s_axil_awvalid,
  output logic                    s_axil_awready,
  input  logic [31:0]             s_axil_wdata,
  input  logic [3:0]              s_axil_wstrb,
  input  logic                    s_axil_wvalid,
  output logic                    s_axil_wready,
  output logic [1:0]              s_axil_bresp,
  output logic                    s_axil_bvalid,
  input  logic                    s_axil_bready,
  input  logic [AddressWidth-1:0] s_axil_araddr,
  input  logic                    s_axil_arvalid,
  output logic                    s_axil_arready,
  output logic [31:0]             s_axil_rdata,
  output logic [1:0]              s_axil_rresp,
  output logic                    s_axil_rvalid,
  input  logic                    s_axil_rready
);

  localparam int Pixels = Rows * Size;
  localparam int DepthWidth = 8 * ((DataWidth + 7) / 8);

  logic [23:0] s_axis_tdata;
  logic s_axis_tvalid, s_axis_tready, s_axis_tlast, s_axis_tuser;
  logic signed [DepthWidth-1:0] m_axis_tdata;
  logic m_axis_tvalid, m_axis_tready, m_axis_tlast, m_axis_tuser;
  logic contact;

  tactile_depth #(
    .Tridiagonal(Tridiagonal), .Neumann(Neumann), .Rows(Rows), .Size(Size),
    .BitsPerChannel(BitsPerChannel), .GradientWidth(GradientWidth), .GradientFraction(GradientFraction),
    .DataWidth(DataWidth), .Width(Width), .CoeffWidth(CoeffWidth), .RowForwardOut(RowForwardOut),
    .ColumnForwardIn(ColumnForwardIn), .ColumnInverseOut(ColumnInverseOut), .RowInverseIn(RowInverseIn),
    .RowInverseOut(RowInverseOut), .DivideShiftWidth(DivideShiftWidth), .DivideDrop(DivideDrop),
    .StoreDrop(StoreDrop), .TableWords(TableWords), .SettledWidth(SettledWidth),
    .LastShiftWidth(LastShiftWidth), .MomentDrop(MomentDrop), .MeanReciprocal(MeanReciprocal),
    .MeanDrop(MeanDrop), .FrameLatency(FrameLatency)
  ) dut (
    .clk, .rst,
    .s_axis_tdata, .s_axis_tvalid, .s_axis_tready, .s_axis_tlast, .s_axis_tuser,
    .m_axis_tdata, .m_axis_tvalid, .m_axis_tready, .m_axis_tlast, .m_axis_tuser, .contact,
    .s_axil_awaddr, .s_axil_awvalid, .s_axil_awready, .s_axil_wdata, .s_axil_wstrb, .s_axil_wvalid,
    .s_axil_wready, .s_axil_bresp, .s_axil_bvalid, .s_axil_bready, .s_axil_araddr, .s_axil_arvalid,
    .s_axil_arready, .s_axil_rdata, .s_axil_rresp, .s_axil_rvalid, .s_axil_rready
  );

  // Marsaglia's xorshift, one step a clock for each side.
  function automatic logic [31:0] xorshift(input logic [31:0] x);
    logic [31:0] y;
    y = x ^ (x << 13);
    y = y ^ (y >> 17);
    return y ^ (y << 5);
  endfunction

  logic [23:0] frame[Pixels];
  logic [31:0] frames_sent, sequence_index, pixel, column, depths, clock, random_gap, random_stall;
  logic fresh, open;  // a depth that was not there before; the frame's first depth has left
  integer frames_file, depth_file, events_file, bytes;

  // The pixel that may be presented next is `frame[pixel]`; a new frame is read when its first pixel is wanted.
  task automatic read_frame;
    begin
      if (sequence_index == 32'd0) bytes = $rewind(frames_file);
      bytes = $fread(frame, frames_file);
      sequence_index <= sequence_index + 32'd1 == sequence_frames ? 32'd0 : sequence_index + 32'd1;
    end
  endtask

  initial begin
    frames_file = $fopen("frames.bin", "rb");
    depth_file = $fopen("depth.bin", "wb");
    events_file = $fopen("events.txt", "w");
  end

  assign s_axis_tdata = frame[pixel];
  assign s_axis_tlast = column == 32'(Size - 1);
  assign s_axis_tuser = pixel == 32'd0;

  always @(posedge clk) begin
    clock <= clock + 32'd1;
    random_gap <= xorshift(random_gap);
    random_stall <= xorshift(random_stall);
    m_axis_tready <= random_stall >= stall;

    if (go && frames_sent != total_frames && (s_axis_tready || !s_axis_tvalid)) begin
      if (s_axis_tvalid) begin
        if (pixel == 32'd0) $fwrite(events_file, "p %0d\n", clock);
        column <= s_axis_tlast ? 32'd0 : column + 32'd1;
        pixel <= pixel + 32'd1;
        if (pixel == 32'(Pixels - 1)) begin
          $fwrite(events_file, "l %0d\n", clock);
          pixel <= 32'd0;
          frames_sent <= frames_sent + 32'd1;
          if (frames_sent + 32'd1 != total_frames) read_frame;
        end
      end else if (frames_sent == 32'd0 && pixel == 32'd0 && sequence_index == 32'd0) begin
        read_frame;
      end
      s_axis_tvalid <= random_gap >= gap
          && !(s_axis_tvalid && pixel == 32'(Pixels - 1) && frames_sent + 32'd1 == total_frames);
    end

    if (m_axis_tvalid) begin
      if (fresh && m_axis_tuser) $fwrite(events_file, "d %0d\n", clock);
      if (fresh && depths == 32'(Pixels - 1)) $fwrite(events_file, "e %0d\n", clock);
      if (m_axis_tready) begin
        $fwrite(depth_file, "%u", 32'(m_axis_tdata));
        depths <= depths == 32'(Pixels - 1) ? 32'd0 : depths + 32'd1;
        if (depths == 32'(Pixels - 1)) frames_received <= frames_received + 32'd1;
      end
    end
    if (m_axis_tvalid && m_axis_tready && m_axis_tuser) open <= 1'b1;
    else if (open && contact) open <= 1'b0;
    if (open && contact) $fwrite(events_file, "c %0d\n", clock);
    fresh <= m_axis_tready || !m_axis_tvalid;

    if (go && frames_received == total_frames && !done) begin
      $fflush(depth_file);
      $fflush(events_file);
      done <= 1'b1;
    end
    if (m_axis_tvalid && m_axis_tready && (m_axis_tlast != ((depths + 32'd1) % 32'(Size) == 32'd0)
        || m_axis_tuser != (depths == 32'd0))) $fatal(1, "%m: a side-band signal is out of place");

    if (rst) begin
      clock <= '0;
      random_gap <= seed;
      random_stall <= ~seed;
      m_axis_tready <= 1'b0;
      s_axis_tvalid <= 1'b0;
      frames_sent <= '0;
      sequence_index <= '0;
      pixel <= '0;
      column <= '0;
      depths <= '0;
      fresh <= 1'b1;
      open <= 1'b0;
      frames_received <= '0;
      done <= 1'b0;
    end
  end

endmodule
