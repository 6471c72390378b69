// SPDX-License-Identifier: Apache-2.0
// fv_picture_pixels: a pixel leaves the clock after its last byte, unchanged, exactly if its packet begins a picture or
// goes on with it, and the picture lacks it; its marks are those of its place. So what leaves are the first pixels of
// pictures, in order. Stable under stall.
//
// Packets may have any length. The specification counts bytes of the packet and pixels of the picture.

parameter int Rows = 3, Columns = 3;

localparam int Pixels = Rows * Columns;
localparam logic [3:0] Header = 4'd8;   // bytes in front of the pixels
localparam logic [3:0] Longest = 4'd10; // the last byte of a pixel; the next one has the number of its first

// The place of the next pixel and the number of its picture are the header of a packet that goes on.
logic takes, begins, goes_on, wanted, differs, moved;
logic [3:0] place;                  // of the next byte in its packet; the one behind Longest is that of Header
logic [31:0] number, picture;       // of the packet, of the picture that began
logic [7:0] position, byte_due;     // pixels of the picture that have come
logic [63:0] header;
assign takes = picture_valid & picture_ready;
assign header = {16'(position % 8'(Columns)), 16'(position / 8'(Columns)), picture};
assign byte_due = 8'(header >> {place[2:0], 3'd0});
assign goes_on = ~differs & picture_data == byte_due;
assign begins = ~moved & picture_data == '0;

logic pixel_due, pixel_last, pixel_user, stalled, is_first, is_last;
logic [23:0] pixel;
logic [7:0] red, green;
assign is_first = position == '0;
assign is_last = (position + 8'd1) % 8'(Columns) == '0;
always_ff @(posedge clk) begin
  stalled <= m_axis_tvalid & ~m_axis_tready;
  pixel_due <= 1'b0;
  if (takes) begin
    place <= place == Longest ? Header : place + 4'd1;
    if (place < Header) differs <= ~goes_on;
    if (place < Header && place > 4'd3) moved <= ~begins;
    if (place < 4'd4) number <= {picture_data, number[31:8]};
    if (place == Header - 4'd1) begin
      wanted <= begins | goes_on;
      if (begins) {picture, position} <= {number, 8'd0};
    end
    if (place == Header) red <= picture_data;
    if (place == Header + 4'd1) green <= picture_data;
    if (place == Longest && wanted && position != 8'(Pixels)) begin
      pixel_due <= 1'b1;
      pixel <= {red, picture_data, green};
      {pixel_last, pixel_user} <= {is_last, is_first};
      position <= position + 8'd1;
    end
    if (picture_last) place <= '0;
    if (picture_last || place >= Header) {differs, moved} <= '0;
  end
  if (rst) begin
    place <= '0;
    position <= 8'(Pixels);
    {differs, moved, stalled, pixel_due} <= '0;
  end
end

always_comb begin
  if (started) begin
    one_at_a_time: assert (picture_ready == !m_axis_tvalid);
    in_its_clock: assert (m_axis_tvalid == (pixel_due || stalled));
    if (m_axis_tvalid) begin
      its_bytes: assert (m_axis_tdata == pixel);
      its_marks: assert ({m_axis_tlast, m_axis_tuser} == {pixel_last, pixel_user});
    end

    last_pixel: cover (m_axis_tvalid && position == 8'(Pixels) && m_axis_tlast && stalled);
    next_packet: cover (pixel_due && position == 8'd2 && place == '0 && picture != '0);
    dropped: cover (takes && place == Longest && !wanted && position == 8'd1);
  end
end
