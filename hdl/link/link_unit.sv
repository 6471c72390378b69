// SPDX-License-Identifier: Apache-2.0
// link_unit: a line of bytes to register accesses and pixels; depth frames, records and replies to the line.
//
//   in --> cobs_decode --> packet_check --> packet_store --> packet_decode --+--> picture_pixels --> m_axis
//                                                                            +--> register_access <--> m_axil
//   out <-- cobs_encode <-- crc_append <-- packet_mux <-- status_packet, register_access, record_packet <-- s_event,
//                                                         depth_packets <-- depth_store <-- s_axis
//
// It stands around tactile_depth: m_axis, m_axil to its s_axis, s_axil; its m_axis, m_event to s_axis, s_event, which
// are never held back. A line with flow control waits for in_ready; one without it loses a packet that finds no room.
// `resets` and the number of the last frame survive rst; cold_rst, together with rst, clears them at power-up.
// Protocol: docs/link.md. Model: models/tactile_depth/chip/link/device.py.

`default_nettype none

module link_unit #(
  parameter int Rows         = 128,
  parameter int Columns      = 128,
  parameter int DataWidth    = 24,
  parameter int Lanes        = 1,   // depths in a beat of s_axis
  parameter int BottomFirst  = 0,   // 1: the bottom row leaves first
  parameter int AddressWidth = 10,  // of m_axil
  localparam int DepthBytes = Lanes * ((DataWidth + 7) / 8)  // of such a beat
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     cold_rst,

  input  wire                     in_valid,
  output logic                    in_ready,
  input  wire  [7:0]              in_data,
  input  wire                     in_broken,  // a byte could not be received, in place of in_valid
  output logic                    out_valid,
  input  wire                     out_ready,
  output logic [7:0]              out_data,

  output logic [23:0]             m_axis_tdata,
  output logic                    m_axis_tvalid,
  input  wire                     m_axis_tready,
  output logic                    m_axis_tlast,
  output logic                    m_axis_tuser,

  input  wire  [8*DepthBytes-1:0] s_axis_tdata,
  input  wire                     s_axis_tvalid,
  input  wire                     s_axis_tlast,
  input  wire                     s_axis_tuser,
  input  wire  [31:0]             s_event_tdata,
  input  wire                     s_event_tvalid,
  input  wire                     s_event_tlast,

  output logic [AddressWidth-1:0] m_axil_awaddr,
  output logic                    m_axil_awvalid,
  input  wire                     m_axil_awready,
  output logic [31:0]             m_axil_wdata,
  output logic                    m_axil_wvalid,
  input  wire                     m_axil_wready,
  input  wire  [1:0]              m_axil_bresp,
  input  wire                     m_axil_bvalid,
  output logic                    m_axil_bready,
  output logic [AddressWidth-1:0] m_axil_araddr,
  output logic                    m_axil_arvalid,
  input  wire                     m_axil_arready,
  input  wire  [31:0]             m_axil_rdata,
  input  wire  [1:0]              m_axil_rresp,
  input  wire                     m_axil_rvalid,
  output logic                    m_axil_rready
);

  // From the line.
  logic piece_valid, piece_end, piece_bad;
  logic [7:0] piece_data;
  cobs_decode u_cobs_decode (
    .clk, .rst, .in_valid(in_valid & in_ready), .in_data, .in_broken, .out_valid(piece_valid), .out_data(piece_data),
    .out_end(piece_end), .out_bad(piece_bad)
  );

  logic packet_valid, packet_end, packet_good;
  logic [7:0] packet_data;
  packet_check u_check (
    .clk, .rst, .in_valid(piece_valid), .in_data(piece_data), .in_end(piece_end), .in_bad(piece_bad),
    .out_valid(packet_valid), .out_data(packet_data), .out_end(packet_end), .out_good(packet_good)
  );

  logic store_bad, decode_bad, stored_valid, stored_ready, stored_last, stored_drop;
  logic [7:0] stored_data;
  logic [10:0] stored_length;
  logic [1:0] stored_length_mod3;
  packet_store u_store (
    .clk, .rst, .in_valid(packet_valid), .in_data(packet_data), .in_end(packet_end), .in_good(packet_good), .in_ready,
    .bad(store_bad), .out_valid(stored_valid), .out_ready(stored_ready), .out_data(stored_data),
    .out_last(stored_last), .out_drop(stored_drop), .out_length(stored_length), .out_length_mod3(stored_length_mod3)
  );

  logic ask, select;
  logic [1:0] select_format;
  logic [4:0] select_shift;
  logic request_valid, request_ready, request_last, request_write;
  logic [7:0] request_data;
  logic picture_valid, picture_ready, picture_last;
  logic [7:0] picture_data;
  packet_decode u_decode (
    .clk, .rst, .in_valid(stored_valid), .in_ready(stored_ready), .in_data(stored_data), .in_last(stored_last),
    .in_drop(stored_drop), .in_length(stored_length), .in_length_mod3(stored_length_mod3), .bad(decode_bad), .ask,
    .select, .select_format, .select_shift, .request_valid, .request_ready, .request_data, .request_last,
    .request_write, .picture_valid, .picture_ready, .picture_data, .picture_last
  );

  logic sliced_valid, sliced_ready, sliced_last;
  logic [7:0] sliced_data;
  td_axis_skid #(.Width(9)) u_picture_slice (
    .clk, .rst, .s_valid(picture_valid), .s_ready(picture_ready), .s_data({picture_last, picture_data}),
    .m_valid(sliced_valid), .m_ready(sliced_ready), .m_data({sliced_last, sliced_data})
  );
  picture_pixels #(.Rows(Rows), .Columns(Columns)) u_pixels (
    .clk, .rst, .picture_valid(sliced_valid), .picture_ready(sliced_ready), .picture_data(sliced_data),
    .picture_last(sliced_last), .m_axis_tdata, .m_axis_tvalid, .m_axis_tready, .m_axis_tlast, .m_axis_tuser
  );

  logic reply_valid, reply_ready, reply_last;
  logic [7:0] reply_data;
  logic asked_valid, asked_ready, asked_last, asked_write;
  logic [7:0] asked_data;
  td_axis_skid #(.Width(10)) u_request_slice (
    .clk, .rst, .s_valid(request_valid), .s_ready(request_ready), .s_data({request_write, request_last, request_data}),
    .m_valid(asked_valid), .m_ready(asked_ready), .m_data({asked_write, asked_last, asked_data})
  );
  register_access #(.AddressWidth(AddressWidth)) u_access (
    .clk, .rst, .forget(ask), .request_valid(asked_valid), .request_ready(asked_ready), .request_data(asked_data),
    .request_last(asked_last), .request_write(asked_write),
    .m_axil_awaddr, .m_axil_awvalid, .m_axil_awready, .m_axil_wdata, .m_axil_wvalid, .m_axil_wready, .m_axil_bresp,
    .m_axil_bvalid, .m_axil_bready, .m_axil_araddr, .m_axil_arvalid, .m_axil_arready, .m_axil_rdata, .m_axil_rresp,
    .m_axil_rvalid, .m_axil_rready, .reply_valid, .reply_ready, .reply_data, .reply_last
  );

  // Settings and counts.
  localparam logic [4:0] FirstShift = DataWidth > 16 ? 5'(DataWidth - 16) : 5'd0;

  logic [1:0] format;        // of the next frame
  logic [4:0] shift;
  logic [15:0] resets = '0;
  logic [31:0] skipped, bad_packets;
  logic was_reset = 1'b1;    // power-up is no reset
  logic skips, skips_q;
  always_ff @(posedge clk) begin
    if (select) {format, shift} <= {select_format, select_shift};
    skipped <= skipped + 32'(skips_q);
    skips_q <= skips;
    bad_packets <= bad_packets + 32'({store_bad & decode_bad, store_bad ^ decode_bad});
    was_reset <= rst;
    if (rst && !was_reset) resets <= resets + 16'd1;
    if (rst) begin
      {format, shift} <= {2'd1, FirstShift};
      skipped <= '0;
      skips_q <= 1'b0;
      bad_packets <= '0;
      if (cold_rst) resets <= '0;
    end
  end

  // Depth frames and records, in registers first: they come at the end of a path of the pipeline.
  logic [8*DepthBytes-1:0] depth_tdata;
  logic depth_tvalid, depth_tlast, depth_tuser, event_tvalid, event_tlast;
  logic [31:0] event_tdata;
  always_ff @(posedge clk) begin
    {depth_tdata, depth_tlast, depth_tuser} <= {s_axis_tdata, s_axis_tlast, s_axis_tuser};
    {event_tdata, event_tlast} <= {s_event_tdata, s_event_tlast};
    {depth_tvalid, event_tvalid} <= rst ? '0 : {s_axis_tvalid, s_event_tvalid};
  end

  logic frame_valid, frame_take, frame_done, value_read;
  logic [$clog2(Rows*Columns)-1:0] value_address;
  logic signed [DataWidth-1:0] value_data;
  logic [3:0] record_word;
  logic [31:0] frame_record_data, sent;
  logic sending;
  depth_store #(.Rows(Rows), .Columns(Columns), .DataWidth(DataWidth), .Lanes(Lanes)) u_depth_store (
    .clk, .rst, .keep(format != '0), .s_axis_tdata(depth_tdata), .s_axis_tvalid(depth_tvalid),
    .s_axis_tlast(depth_tlast), .s_axis_tuser(depth_tuser), .s_event_tdata(event_tdata),
    .s_event_tvalid(event_tvalid), .s_event_tlast(event_tlast), .skipped(skips), .frame_valid, .frame_take,
    .frame_done, .value_read, .value_address, .value_data, .record_word, .record_data(frame_record_data)
  );

  logic depth_valid, depth_ready, depth_last;
  logic [7:0] depth_data;
  depth_packets #(
    .Rows(Rows), .Columns(Columns), .DataWidth(DataWidth), .BottomFirst(BottomFirst)
  ) u_depth_packets (
    .clk, .rst, .cold_rst, .format, .shift, .resets, .frame_valid, .frame_take, .frame_done, .value_read,
    .value_address, .value_data, .record_word, .record_data(frame_record_data), .depth_valid, .depth_ready,
    .depth_data, .depth_last, .sent, .sending
  );

  logic record_valid, record_ready, record_last;
  logic [7:0] record_data;
  record_packet u_record (
    .clk, .rst, .s_event_tdata(event_tdata), .s_event_tvalid(event_tvalid), .s_event_tlast(event_tlast),
    .record_valid, .record_ready, .record_data, .record_last
  );

  logic status_valid, status_ready, status_last;
  logic [7:0] status_data;
  status_packet u_status (
    .clk, .rst, .request(ask | select),
    .fields({bad_packets, skipped, sent, 3'd0, shift, 6'd0, format, 6'd0, sending, BottomFirst != 0, 8'(DataWidth),
      16'(Columns), 16'(Rows), resets}),
    .status_valid, .status_ready, .status_data, .status_last
  );

  // To the line.
  logic mixed_valid, mixed_ready, mixed_last, packet_out_valid, packet_out_ready, packet_out_last;
  logic checked_valid, checked_ready, checked_last;
  logic [7:0] mixed_data, packet_out_data, checked_data;
  // Status, reply, record and depth, each through a slice: {last, byte}.
  logic [3:0] source_ready, valid, ready;
  logic [3:0][8:0] source_data, data;
  assign {status_ready, reply_ready, record_ready, depth_ready} = source_ready;
  assign source_data = {status_last, status_data, reply_last, reply_data, record_last, record_data,
    depth_last, depth_data};
  td_axis_skid #(.Width(9)) u_source_slice[3:0] (
    .clk, .rst, .s_valid({status_valid, reply_valid, record_valid, depth_valid}), .s_ready(source_ready),
    .s_data(source_data), .m_valid(valid), .m_ready(ready), .m_data(data)
  );
  packet_mux u_mux (
    .clk, .rst, .status_valid(valid[3]), .status_ready(ready[3]), .status_data(data[3][7:0]), .status_last(data[3][8]),
    .reply_valid(valid[2]), .reply_ready(ready[2]), .reply_data(data[2][7:0]), .reply_last(data[2][8]),
    .record_valid(valid[1]), .record_ready(ready[1]), .record_data(data[1][7:0]), .record_last(data[1][8]),
    .depth_valid(valid[0]), .depth_ready(ready[0]), .depth_data(data[0][7:0]), .depth_last(data[0][8]),
    .out_valid(mixed_valid), .out_ready(mixed_ready), .out_data(mixed_data), .out_last(mixed_last)
  );
  td_axis_skid #(.Width(9)) u_packet_slice (
    .clk, .rst, .s_valid(mixed_valid), .s_ready(mixed_ready), .s_data({mixed_last, mixed_data}),
    .m_valid(packet_out_valid), .m_ready(packet_out_ready), .m_data({packet_out_last, packet_out_data})
  );
  crc_append u_crc (
    .clk, .rst, .in_valid(packet_out_valid), .in_ready(packet_out_ready), .in_data(packet_out_data),
    .in_last(packet_out_last),
    .out_valid(checked_valid), .out_ready(checked_ready), .out_data(checked_data), .out_last(checked_last)
  );
  logic piece_out_valid, piece_out_ready, piece_out_last;
  logic [7:0] piece_out_data;
  td_axis_skid #(.Width(9)) u_checked_slice (
    .clk, .rst, .s_valid(checked_valid), .s_ready(checked_ready), .s_data({checked_last, checked_data}),
    .m_valid(piece_out_valid), .m_ready(piece_out_ready), .m_data({piece_out_last, piece_out_data})
  );
  cobs_encode u_cobs_encode (
    .clk, .rst, .in_valid(piece_out_valid), .in_ready(piece_out_ready), .in_data(piece_out_data),
    .in_last(piece_out_last),
    .out_valid, .out_ready, .out_data
  );

  // Refused.

  if (Rows < 2 || Rows > 4096) begin : g_refused_0
    Rows_must_be_2_to_4096 u_refused ();
  end
  if (Columns < 2 || Columns > 4096 || Columns != 1 << $clog2(Columns)) begin : g_refused_1
    Columns_must_be_a_power_of_two_2_to_4096 u_refused ();
  end
  if (DataWidth < 2 || DataWidth > 32) begin : g_refused_2
    DataWidth_must_be_2_to_32 u_refused ();
  end
  if (Lanes < 1 || Columns % Lanes != 0) begin : g_refused_3
    Lanes_must_divide_Columns u_refused ();
  end
  if (AddressWidth < 2 || AddressWidth > 16) begin : g_refused_4
    AddressWidth_must_be_2_to_16 u_refused ();
  end

endmodule

`default_nettype wire
