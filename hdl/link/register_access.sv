// SPDX-License-Identifier: Apache-2.0
// register_access: requests of a host to accesses of registers, each done once, and the replies to them.
//
// A request is a packet of bytes without its kind: request number, then for each access an address of 2 bytes and, if
// request_write is high, a value of 4 bytes; only whole accesses come, 1 to Accesses of them. They are done one at a
// time on AXI4-Lite. One that is refused ends the request: the rest is taken and does nothing. Refused is what the port
// answers with a response other than 0, and, without an access, an address with bits above AddressWidth.
//
// The reply is a packet of bytes: kind, request number, accesses done, values read (docs/link.md). A request with kind
// and number of the last one is not done again: the same reply leaves again, unless `forget` was high since the last
// one began. The next request waits until the reply has left. Latency: an access is offered 2 clocks after its last
// byte, the first byte of a reply the clock after the answer to the last access. Model: LinkDevice in
// models/tactile_depth/chip/link/device.py.

`default_nettype none

module register_access
  import td_link_pkg::*;
#(
  parameter int AddressWidth = 10,  // 2 to 16
  parameter int Accesses     = MostAccesses  // in a request; fewer make a smaller memory, for proofs
) (
  input  wire                     clk,
  input  wire                     rst,
  input  wire                     forget,

  input  wire                     request_valid,
  output logic                    request_ready,
  input  wire  [7:0]              request_data,
  input  wire                     request_last,
  input  wire                     request_write,

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
  output logic                    m_axil_rready,

  output logic                    reply_valid,
  input  wire                     reply_ready,
  output logic [7:0]              reply_data,
  output logic                    reply_last
);

  localparam int WordWidth = $clog2(Accesses);
  localparam int DoneWidth = $clog2(Accesses + 1);

  // StNumber: no request. StCollect: bytes of an access come. StBegin, StAccess: it is done. StSwallow: the rest of a
  // request does nothing. StReply: the reply leaves.
  typedef enum logic [2:0] {StNumber, StCollect, StBegin, StAccess, StSwallow, StReply} state_e;
  state_e state;
  logic known;     // the last request may be repeated: these are its kind, number and the accesses done
  logic is_write;
  logic [7:0] number;
  logic [DoneWidth-1:0] done;

  // Bytes of a request.

  logic takes, repeated, access_whole, ends;  // ends: the access is the last of its request
  logic [2:0] place;                          // of the next byte in its access
  logic [15:0] address;
  logic [31:0] value;
  assign request_ready = state == StNumber || state == StCollect || state == StSwallow;
  assign takes = request_valid & request_ready;
  assign repeated = known & (request_write == is_write) & (request_data == number);
  assign access_whole = place == (is_write ? 3'd5 : 3'd1);

  // The access.

  logic beyond, answered, refused;
  assign beyond = (17'(address) >> AddressWidth) != '0;
  assign m_axil_awaddr = address[AddressWidth-1:0];
  assign m_axil_araddr = address[AddressWidth-1:0];
  assign m_axil_wdata = value;
  assign m_axil_bready = (state == StAccess) & is_write;
  assign m_axil_rready = (state == StAccess) & ~is_write;
  assign answered = (m_axil_bready & m_axil_bvalid) | (m_axil_rready & m_axil_rvalid);
  assign refused = (is_write ? m_axil_bresp : m_axil_rresp) != '0;

  // The reply, byte by byte. A word is read as the byte before its first one leaves.

  logic [DoneWidth+1:0] sent;  // bytes of the reply that have left
  logic leaves;
  logic [1:0] byte_of_word;
  logic [31:0] word;
  assign byte_of_word = sent[1:0] + 2'd1;
  assign leaves = reply_valid & reply_ready;
  assign reply_valid = state == StReply;
  assign reply_last = sent == {is_write ? DoneWidth'(0) : done, 2'd2};
  always_comb begin
    case (sent)
      (DoneWidth + 2)'(0): reply_data = is_write ? WriteReply : ReadReply;
      (DoneWidth + 2)'(1): reply_data = number;
      (DoneWidth + 2)'(2): reply_data = 8'(done);
      default: reply_data = 8'(word >> {byte_of_word, 3'd0});
    endcase
  end

  td_ram #(.Width(32), .Depth(Accesses), .Style(32 * Accesses > td_memory_pkg::LateBits ? 1 : 0)) u_values (
    .clk, .write_en(m_axil_rready & m_axil_rvalid), .write_address(done[WordWidth-1:0]), .write_data(m_axil_rdata),
    .read_en(leaves & (sent[1:0] == 2'd2) & ~reply_last), .read_address(sent[WordWidth+1:2]), .read_data(word)
  );

  always_ff @(posedge clk) begin
    if (state == StNumber) begin
      place <= '0;
      sent <= '0;
      if (takes) begin
        state <= repeated ? StSwallow : StCollect;
        known <= 1'b1;
        is_write <= request_write;
        number <= request_data;
        if (!repeated) done <= '0;
      end
    end
    if (state == StCollect && takes) begin
      place <= place + 3'd1;
      if (place[2:1] == '0) address <= {request_data, address[15:8]};
      else value <= {request_data, value[31:8]};
      ends <= request_last;
      if (access_whole) state <= StBegin;
    end
    if (state == StBegin) begin
      place <= '0;
      state <= !beyond ? StAccess : ends ? StReply : StSwallow;
      m_axil_awvalid <= ~beyond & is_write;
      m_axil_wvalid <= ~beyond & is_write;
      m_axil_arvalid <= ~beyond & ~is_write;
    end
    if (state == StAccess) begin
      if (m_axil_awready) m_axil_awvalid <= 1'b0;
      if (m_axil_wready) m_axil_wvalid <= 1'b0;
      if (m_axil_arready) m_axil_arvalid <= 1'b0;
      if (answered) begin
        state <= ends ? StReply : refused ? StSwallow : StCollect;
        if (!refused) done <= done + DoneWidth'(1);
      end
    end
    if (state == StSwallow && takes && request_last) state <= StReply;
    if (leaves) begin
      sent <= sent + (DoneWidth + 2)'(1);
      if (reply_last) state <= StNumber;
    end
    if (forget) known <= 1'b0;
    if (rst) begin
      state <= StNumber;
      known <= 1'b0;
      m_axil_awvalid <= 1'b0;
      m_axil_wvalid <= 1'b0;
      m_axil_arvalid <= 1'b0;
    end
  end

endmodule

`default_nettype wire
