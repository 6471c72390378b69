// SPDX-License-Identifier: Apache-2.0
// frame_bench: plays a file through tactile_depth without a coroutine step a clock.
//
// entries.bin holds entries of 32 bits, highest byte first; its kind is in bits 31:28.
//   0  a pixel: 27 note the clock in which it is taken, 25 tuser, 24 tlast, 23:0 tdata. Offered until it is taken
//   1  23:0 clocks without a pixel
//   2  the sink: ready for 23:12 clocks, then 11:0 not, and so on; if 23:12 is zero not with probability 11:0 / 4096
//   3  the source: pixels are offered so
//   4  23:0 clocks of reset, one clock to come out of it
//   5  23:0 clocks from here on, whatever stands on the pins then is withdrawn and the file goes on at the entry whose
//      number comes next, a reset
// It is played `passes` times. depth.bin receives the codes that leave, four bytes each; events.txt one line per event:
//   t clock        a pixel with a note was taken
//   d, e clock     first and last beat of a frame on m_axis
//   b clock        the frame's first beat with a depth above `level` leaves
//   c clock        `contact` is up, the first time since the frame's first depth left
//   f fault clock  the guard flags a fault, by the number of its name in models/tactile_depth/chip/video/frame_guard.py
//   r clock codes  a reset begins; codes written so far
// A side-band signal out of place, a word that changes before it is taken, an unknown one: the run ends with an error.
// Registers are reached through the AXI4-Lite ports. tactile_depth_bench, and with Camera 1 tactile_sensor_bench, is a
// wrapper that commands/common/wrapper.py writes for each configuration. Simulation only.

`default_nettype none

// verilator lint_off PINCONNECTEMPTY
module frame_bench
  import td_register_map_pkg::*;
#(
  parameter int Rows      = 128,  // of the wrapper
  parameter int Columns   = 128,
  parameter int DataWidth = 24,
  parameter int Lanes     = 1,
  parameter int Camera    = 0
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     go,
  input  wire  [31:0]             passes,        // how often the file is played
  input  wire  [31:0]             total_frames,  // done when so many have left, and not before the file has ended
  input  wire  [31:0]             seed,          // not 0
  input  wire  signed [31:0]      level,
  output logic                    done,
  output logic [31:0]             frames_received,

  input  wire  [AddressWidth-1:0] s_axil_awaddr,
  input  wire                     s_axil_awvalid,
  output logic                    s_axil_awready,
  input  wire  [31:0]             s_axil_wdata,
  input  wire  [3:0]              s_axil_wstrb,
  input  wire                     s_axil_wvalid,
  output logic                    s_axil_wready,
  output logic [1:0]              s_axil_bresp,
  output logic                    s_axil_bvalid,
  input  wire                     s_axil_bready,
  input  wire  [AddressWidth-1:0] s_axil_araddr,
  input  wire                     s_axil_arvalid,
  output logic                    s_axil_arready,
  output logic [31:0]             s_axil_rdata,
  output logic [1:0]              s_axil_rresp,
  output logic                    s_axil_rvalid,
  input  wire                     s_axil_rready
);

  localparam int Beats = Rows * Columns / Lanes;  // of a frame of depth
  localparam int DepthWidth = 8 * ((DataWidth + 7) / 8);

  logic [23:0] s_axis_tdata;
  logic s_axis_tvalid, s_axis_tready, s_axis_tlast, s_axis_tuser;
  logic [Lanes*DepthWidth-1:0] m_axis_tdata;
  logic m_axis_tvalid, m_axis_tready, m_axis_tlast, m_axis_tuser;
  logic contact, resetting;
  logic [4:0] flagged;

  if (Camera != 0) begin : g_camera
    tactile_sensor_bench dut (
      .clk, .rst(rst | resetting), .cold_rst(1'b0),
      .s_axis_tdata, .s_axis_tvalid, .s_axis_tready, .s_axis_tlast, .s_axis_tuser,
      .m_axis_tdata, .m_axis_tvalid, .m_axis_tready, .m_axis_tlast, .m_axis_tuser, .contact, .irq(),
      .m_event_tdata(), .m_event_tvalid(), .m_event_tready(1'b1), .m_event_tlast(),
      .s_axil_awaddr, .s_axil_awprot('0), .s_axil_awvalid, .s_axil_awready, .s_axil_wdata, .s_axil_wstrb,
      .s_axil_wvalid, .s_axil_wready, .s_axil_bresp, .s_axil_bvalid, .s_axil_bready, .s_axil_araddr,
      .s_axil_arprot('0), .s_axil_arvalid, .s_axil_arready, .s_axil_rdata, .s_axil_rresp, .s_axil_rvalid,
      .s_axil_rready,
      .frames_lost('0), .setup_restart(), .setup_done('0), .setup_failed('0), .setup_entry('0),
      .setup_found('0)
    );
    assign flagged = dut.u_sensor.u_pipeline.u_video.faults;
  end else begin : g_grid
    tactile_depth_bench dut (
      .clk, .rst(rst | resetting), .cold_rst(1'b0),
      .s_axis_tdata, .s_axis_tvalid, .s_axis_tready, .s_axis_tlast, .s_axis_tuser,
      .m_axis_tdata, .m_axis_tvalid, .m_axis_tready, .m_axis_tlast, .m_axis_tuser, .contact, .irq(),
      .m_event_tdata(), .m_event_tvalid(), .m_event_tready(1'b1), .m_event_tlast(),
      .s_axil_awaddr, .s_axil_awprot('0), .s_axil_awvalid, .s_axil_awready, .s_axil_wdata, .s_axil_wstrb,
      .s_axil_wvalid, .s_axil_wready, .s_axil_bresp, .s_axil_bvalid, .s_axil_bready, .s_axil_araddr,
      .s_axil_arprot('0), .s_axil_arvalid, .s_axil_arready, .s_axil_rdata, .s_axil_rresp, .s_axil_rvalid, .s_axil_rready
    );
    assign flagged = dut.u_pipeline.u_video.faults;
  end

  // Marsaglia's xorshift, one step a clock for each side.
  function automatic logic [31:0] xorshift(input logic [31:0] x);
    logic [31:0] y;
    y = x ^ (x << 13);
    y = y ^ (y >> 17);
    return y ^ (y << 5);
  endfunction

  localparam logic [3:0] Pixel = 4'd0, Idle = 4'd1, Sink = 4'd2, Source = 4'd3, Reset = 4'd4, Arm = 4'd5;

  logic [31:0] clock, random_gap, random_stall, passes_left, wait_left, reset_left, deadline, target;
  logic [23:0] source, sink, source_place, sink_place;
  logic note, ended, offers, withdraw, was_resetting;
  logic [31:0] beats, codes;
  logic signed [31:0] depths[Lanes];  // of the beat
  logic [Lanes-1:0] above;
  logic fresh, open;  // a depth that was not there before; the frame's first depth has left
  logic below;        // no depth above the level has left since the frame began
  logic refused;
  logic started;  // a reset was seen: what registers come up with, in the first clock, is nobody's fault
  logic [Lanes*DepthWidth+1:0] leaving, held;
  integer entries_file, depth_file, events_file, bytes;

  function automatic logic accepts(input logic [23:0] turns, input logic [23:0] place, input logic [31:0] chance);
    return turns[23:12] == 12'd0 ? chance >= {turns[11:0], 20'd0} : place < 24'(turns[23:12]);
  endfunction

  function automatic logic [23:0] step(input logic [23:0] turns, input logic [23:0] place);
    return place + 24'd1 >= 24'(turns[23:12]) + 24'(turns[11:0]) ? 24'd0 : place + 24'd1;
  endfunction

  // Reads on up to an entry that takes time, and puts it on the pins; with `jump` from the target on.
  task automatic read_entry(input logic jump);
    logic [31:0] word;
    logic at_once;
    begin
      if (jump) bytes = $fseek(entries_file, 4 * target, 0);
      s_axis_tvalid <= 1'b0;
      at_once = 1'b1;
      while (at_once) begin
        bytes = $fread(word, entries_file);
        at_once = 1'b0;
        if (bytes != 4) begin
          if (passes_left == 32'd1) begin
            ended <= 1'b1;
          end else begin
            passes_left <= passes_left - 32'd1;
            bytes = $rewind(entries_file);
            at_once = 1'b1;
          end
        end else begin
          case (word[31:28])
            Pixel: begin
              s_axis_tvalid <= 1'b1;
              {note, s_axis_tuser, s_axis_tlast, s_axis_tdata} <= {word[27], word[25:0]};
            end
            Idle: wait_left <= 32'(word[23:0]) - 32'd1;
            Sink: begin
              {sink, sink_place} <= {word[23:0], 24'd0};
              at_once = 1'b1;
            end
            Source: begin
              {source, source_place} <= {word[23:0], 24'd0};
              at_once = 1'b1;
            end
            Reset: begin
              resetting <= 1'b1;
              reset_left <= 32'(word[23:0]);
              deadline <= 32'd0;
            end
            Arm: begin
              deadline <= 32'(word[23:0]);
              bytes = $fread(word, entries_file);
              target <= word;
              at_once = 1'b1;
            end
            default: $fatal(1, "%m: no such entry: 0x%h", word);
          endcase
        end
      end
    end
  endtask

  initial begin
    entries_file = $fopen("entries.bin", "rb");
    depth_file = $fopen("depth.bin", "wb");
    events_file = $fopen("events.txt", "w");
    started = 1'b0;
  end

  assign offers = accepts(source, source_place, random_gap);
  assign withdraw = deadline == 32'd1;
  for (genvar lane = 0; lane < Lanes; lane++) begin : g_lane
    assign depths[lane] = 32'($signed(m_axis_tdata[lane*DepthWidth+:DepthWidth]));
    assign above[lane] = depths[lane] > level;
  end
  assign leaving = {m_axis_tuser, m_axis_tlast, m_axis_tdata};

  always @(posedge clk) begin
    clock <= clock + 32'd1;
    random_gap <= xorshift(random_gap);
    random_stall <= xorshift(random_stall);
    source_place <= step(source, source_place);
    sink_place <= step(sink, sink_place);
    m_axis_tready <= accepts(sink, sink_place, random_stall);
    if (deadline != 32'd0) deadline <= deadline - 32'd1;

    // In.

    if (started && s_axis_tvalid && s_axis_tready && note && !resetting) $fwrite(events_file, "t %0d\n", clock);
    if (!started) begin
      resetting <= 1'b0;
    end else if (resetting) begin
      if (!rst && !was_resetting) $fwrite(events_file, "r %0d %0d\n", clock, codes);
      reset_left <= reset_left - 32'd1;
      if (reset_left == 32'd1) resetting <= 1'b0;
    end else if (withdraw) begin
      wait_left <= 32'd0;
      read_entry(1'b1);
    end else if (go && !ended && (s_axis_tready || !s_axis_tvalid)) begin
      if (wait_left != 32'd0) begin
        wait_left <= wait_left - 32'd1;
        s_axis_tvalid <= 1'b0;
      end else if (offers) begin
        read_entry(1'b0);
      end else begin
        s_axis_tvalid <= 1'b0;
      end
    end

    // Out.

    if (started && !rst && !resetting) begin
      if (^{s_axis_tready, m_axis_tvalid, contact} === 1'bx) $fatal(1, "%m: an unknown handshake");
      if (m_axis_tvalid && ^leaving === 1'bx) $fatal(1, "%m: an unknown word");
      if (refused && (!m_axis_tvalid || leaving != held)) $fatal(1, "%m: a word changed before it was taken");
      for (int i = 0; i < 5; i++) begin
        if (flagged[i]) $fwrite(events_file, "f %0d %0d\n", i, clock);
      end
      if (m_axis_tvalid) begin
        if (fresh && m_axis_tuser) $fwrite(events_file, "d %0d\n", clock);
        if (fresh && beats == 32'(Beats - 1)) $fwrite(events_file, "e %0d\n", clock);
        if (m_axis_tready) begin
          if ((below || m_axis_tuser) && above != '0) $fwrite(events_file, "b %0d\n", clock);
          below <= (below || m_axis_tuser) && above == '0;
          for (int lane = 0; lane < Lanes; lane++) $fwrite(depth_file, "%u", depths[lane]);
          codes <= codes + 32'(Lanes);
          beats <= beats == 32'(Beats - 1) ? 32'd0 : beats + 32'd1;
          if (beats == 32'(Beats - 1)) frames_received <= frames_received + 32'd1;
          if (m_axis_tlast != ((beats + 32'd1) % 32'(Columns / Lanes) == 32'd0) || m_axis_tuser != (beats == 32'd0))
            $fatal(1, "%m: a side-band signal is out of place");
        end
      end
      if (m_axis_tvalid && m_axis_tready && m_axis_tuser) open <= 1'b1;
      else if (open && contact) open <= 1'b0;
      if (open && contact) $fwrite(events_file, "c %0d\n", clock);
    end
    fresh <= m_axis_tready || !m_axis_tvalid;
    refused <= m_axis_tvalid && !m_axis_tready;
    held <= leaving;
    was_resetting <= resetting;
    if (rst) started <= 1'b1;

    if (go && ended && frames_received >= total_frames && !done) begin
      $fflush(depth_file);
      $fflush(events_file);
      done <= 1'b1;
    end

    if (rst || resetting) begin
      beats <= '0;
      fresh <= 1'b1;
      open <= 1'b0;
      refused <= 1'b0;
    end
    if (rst) begin
      clock <= '0;
      random_gap <= seed;
      random_stall <= ~seed;
      passes_left <= passes;
      {source, sink, source_place, sink_place} <= {24'd0, 24'd0, 24'd0, 24'd0};
      {wait_left, reset_left, deadline} <= {32'd0, 32'd0, 32'd0};
      resetting <= 1'b0;
      ended <= 1'b0;
      note <= 1'b0;
      m_axis_tready <= 1'b0;
      s_axis_tvalid <= 1'b0;
      codes <= '0;
      frames_received <= '0;
      done <= 1'b0;
    end
  end

endmodule

`default_nettype wire
