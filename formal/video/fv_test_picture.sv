// SPDX-License-Identifier: Apache-2.0
// fv_test_picture: words pass, but while a picture goes through: then none is taken, and the pixels that leave are those
// of the register from Seed on, with a start of frame on the first and ends of row where they should be. A picture begins
// only between two frames and only where one was asked for, and ends with the frame. Whatever the guard behind does.

logic asked, begun;  // for a picture; its first pixel was taken
logic [23:0] pixel;
logic goes, goes_on;
assign goes = asked && (begun || between);
assign goes_on = goes && m_ready;
always_ff @(posedge clk) begin
  if (request) asked <= 1'b1;
  else if (goes_on && frame_ends) asked <= 1'b0;
  if (goes_on) begin
    begun <= !frame_ends;
    for (int n = 0; n < 24; n++) begin
      pixel[n] <= frame_ends ? Seed[n] : n < 12 ? pixel[n+12] ^ pixel[n+11] ^ pixel[n+10] ^ pixel[n+5] : pixel[n-12];
    end
  end
  if (rst) begin
    {asked, begun} <= '0;
    pixel <= Seed;
  end
end

always_comb begin
  if (started) begin
    own: assert (m_test == goes);
    taken_once: assert ((s_ready && s_valid) == (m_ready && m_valid && !goes));
    offered: assert (m_valid == (goes || s_valid));
    if (goes) picture: assert (m_data == pixel && m_user == !begun && m_last == row_ends);
    if (!goes && m_valid) passes: assert ({m_data, m_user, m_last} == {s_data, s_user, s_last});
    waits: cover (asked && !goes && m_valid && m_ready);
    third_pixel: cover (goes_on && begun && frame_ends && pixel != Seed && s_valid);
    asked_again: cover (goes_on && frame_ends && request);
  end
end
