// SPDX-License-Identifier: Apache-2.0
// dvp_receive: bytes of a parallel camera (DVP) from the camera's clock into the system's.
//
// In, on pclk, which runs between rows too: a frame begins as vsync rises, where a pulse between frames begins or ends;
// href high in any other clock brings a byte; href low ends a row. Stream out, on clk: the bytes of a frame in
// their order, tuser with its first, tlast with the last of each row. A byte crosses in 2 clocks of pclk and 3 or 4 of
// clk (td_async_fifo).
//
// Back-pressure ends at 2^FifoLog2 bytes: the camera does not wait. A frame with a byte that finds no room is given up:
// no byte of it follows, so that what has left is a frame cut short, and the next frame is whole. frames_lost is the
// number of frames given up, for one clock, as the next frame arrives; 255 stands for more.
//
// After a reset nothing leaves until a frame begins. The side of pclk has no reset, since pclk may stand still in it:
// it begins with initial values. Model: models/tactile_depth/chip/camera/dvp_receive.py.

`default_nettype none

module dvp_receive #(
  parameter int FifoLog2 = 4
) (
  input  wire        pclk,
  input  wire        vsync,
  input  wire        href,
  input  wire  [7:0] data,

  input  wire        clk,
  input  wire        rst,
  output logic [7:0] m_axis_tdata,
  output logic       m_axis_tvalid,
  input  wire        m_axis_tready,
  output logic       m_axis_tlast,
  output logic       m_axis_tuser,
  output logic [7:0] frames_lost
);

  // The camera's side. A byte is held for a clock, until the next one or the end of the row comes. The word in front of
  // a frame's bytes is {1, 0, frames given up before it}, that of a byte {0, last of its row, byte}.

  logic vsync_q = 1'b0, vsync_q2 = 1'b0, href_q = 1'b0;
  logic [7:0] data_q, held_data;
  logic opening = 1'b0;    // the word in front of a frame waits for room
  logic receiving = 1'b0;  // it has found room, and so has every byte since
  logic held = 1'b0;
  logic [7:0] given_up = '0;
  logic starts, in_row, write_ready, begins, no_room;
  assign starts = vsync_q & ~vsync_q2;
  assign in_row = href_q & ~starts;
  assign begins = opening & write_ready;
  assign no_room = ~write_ready & (held | (opening & in_row));

  always_ff @(posedge pclk) begin
    vsync_q <= vsync;
    vsync_q2 <= vsync_q;
    href_q <= href;
    data_q <= data;
    held_data <= data_q;
    held <= in_row & (receiving | begins) & ~no_room;
    if (begins) begin
      receiving <= 1'b1;
      given_up <= '0;
    end else if (no_room) begin
      receiving <= 1'b0;
      if (given_up != '1) given_up <= given_up + 8'd1;
    end
    if (starts) begin
      opening <= 1'b1;
      receiving <= 1'b0;
    end else if (begins || no_room) begin
      opening <= 1'b0;
    end
  end

  logic read_valid, read_ready;
  logic [9:0] word;
  td_async_fifo #(.Width(10), .DepthLog2(FifoLog2)) u_fifo (
    .write_clk(pclk), .write_valid(opening | held), .write_ready,
    .write_data(opening ? {2'b10, given_up} : {1'b0, ~in_row, held_data}),
    .read_clk(clk), .read_valid, .read_ready, .read_data(word)
  );

  // The system's side.

  logic front, opened;  // opened: a frame has begun since the reset
  assign front = word[9];
  assign read_ready = m_axis_tready | ~m_axis_tvalid;
  assign m_axis_tvalid = read_valid & ~front & opened;
  assign {m_axis_tlast, m_axis_tdata} = word[8:0];

  always_ff @(posedge clk) begin
    frames_lost <= '0;
    if (read_valid && front) begin
      opened <= 1'b1;
      m_axis_tuser <= 1'b1;
      frames_lost <= word[7:0];
    end else if (m_axis_tvalid && m_axis_tready) begin
      m_axis_tuser <= 1'b0;
    end
    if (rst) begin
      opened <= 1'b0;
      frames_lost <= '0;
    end
  end

  if (FifoLog2 < 3) begin : g_refused
    FifoLog2_must_be_at_least_3_or_nearly_equal_clocks_lose_every_frame u_refused ();
  end

endmodule

`default_nettype wire
