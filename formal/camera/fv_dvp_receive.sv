// SPDX-License-Identifier: Apache-2.0
// fv_dvp_receive: what enters the queue is a front for each frame that finds room, then its bytes without a hole, up to
// the first that finds none; each frame given up is counted once, in the next front. What leaves are the bytes of the
// queue, in order, from the first front after a reset on, with their marks; the counts leave once.
//
// Room in the queue, and what comes out of it, are free, but that a word stays until it is taken: td_async_fifo is proven by
// itself. Both clocks rise whenever they like.

// The camera's side.

logic offered, room, front, byte_offered;
logic [9:0] word;
assign offered = dut.u_fifo.write_valid;
assign room = dut.write_ready;
assign word = dut.u_fifo.write_data;
assign front = word[9];
assign byte_offered = offered & ~front;

logic vsync_q = 1'b0, vsync_q2 = 1'b0, href_q = 1'b0, in_row, in_row_q = 1'b0;
logic [7:0] data_q, data_q2;
assign in_row = href_q & ~(vsync_q & ~vsync_q2);
logic due = 1'b0;     // the front of this frame has not entered
logic broken = 1'b1;  // this frame is given up, or none has begun
logic [7:0] count = '0;
logic refused;
assign refused = ~broken & ~room & (due ? in_row : in_row_q);
always_ff @(posedge pclk) begin
  vsync_q <= vsync;
  vsync_q2 <= vsync_q;
  href_q <= href;
  data_q <= data;
  data_q2 <= data_q;
  in_row_q <= in_row;
  if (offered && room && front) begin
    due <= 1'b0;
    count <= '0;
  end
  if (refused) begin
    broken <= 1'b1;
    due <= 1'b0;
    if (count != 8'd255) count <= count + 8'd1;
  end
  if (vsync_q && !vsync_q2) begin
    due <= 1'b1;
    broken <= 1'b0;
  end
end

always_comb begin
  if (due) front_offered: assert (offered && word == {2'b10, count});
  if (!due) no_second_front: assert (!(offered && front));
  if (!due && !broken) each_byte: assert (byte_offered == in_row_q);
  if (broken && !due) nothing_of_it_follows: assert (!offered);
  if (byte_offered) its_own: assert (word == {1'b0, ~in_row, data_q2});
  refused_and_counted: cover (due && count == 8'd2 && room);
  whole_row: cover (byte_offered && room && word[8]);
end

// The system's side.

logic taken, opened, first, started = 1'b0, waits = 1'b0, fresh = 1'b1;
logic [9:0] waiting;
logic [7:0] lost;
assign taken = dut.read_valid & dut.read_ready;
always_ff @(posedge clk) begin
  started <= 1'b1;
  fresh <= rst;
  waits <= dut.read_valid & ~dut.read_ready;
  waiting <= dut.word;
  lost <= taken & dut.word[9] & ~rst ? dut.word[7:0] : '0;
  if (taken) begin
    opened <= opened | dut.word[9];
    first <= dut.word[9];
  end
  if (rst) opened <= 1'b0;
end

always_comb begin
  if (!started) assume (rst);
  if (waits) assume (dut.read_valid && dut.word == waiting);
  if (started) begin
    offers: assert (m_axis_tvalid == (dut.read_valid && !dut.word[9] && opened));
    takes: assert (dut.read_ready == (m_axis_tready || !m_axis_tvalid));
    counted_once: assert (frames_lost == lost);
    if (fresh) silent_after_reset: assert (!m_axis_tvalid && frames_lost == '0);
    if (m_axis_tvalid) marks: assert ({m_axis_tlast, m_axis_tdata} == dut.word[8:0] && m_axis_tuser == first);
    second_byte: cover (m_axis_tvalid && !m_axis_tuser && !m_axis_tready);
    first_byte: cover (m_axis_tvalid && m_axis_tuser && frames_lost == 8'd3);
  end
end
