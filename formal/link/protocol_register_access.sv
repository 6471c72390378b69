// SPDX-License-Identifier: Apache-2.0
// protocol_register_access: requests are whole: a number, then 1 to Accesses accesses, all of one kind; `forget` comes
// between them. The port answers an access once, after it was taken. What is offered stays until it is taken. The ready
// of an answer counts while it is offered.

`default_nettype none

module protocol_register_access #(
  parameter int Accesses = 128
) (
  input  logic        clk,
  input  logic        rst,
  input  logic        forget,
  input  logic        request_valid,
  input  logic        request_ready,
  input  logic [7:0]  request_data,
  input  logic        request_last,
  input  logic        request_write,
  input  logic        m_axil_awvalid,
  input  logic        m_axil_awready,
  input  logic        m_axil_wvalid,
  input  logic        m_axil_wready,
  input  logic [1:0]  m_axil_bresp,
  input  logic        m_axil_bvalid,
  input  logic        m_axil_bready,
  input  logic        m_axil_arvalid,
  input  logic        m_axil_arready,
  input  logic [31:0] m_axil_rdata,
  input  logic [1:0]  m_axil_rresp,
  input  logic        m_axil_rvalid,
  input  logic        m_axil_rready,
  input  logic        reply_valid,
  output logic        holds,
  output logic        counts_m_axil_awaddr,
  output logic        counts_m_axil_wdata,
  output logic        counts_m_axil_araddr,
  output logic        counts_m_axil_bready,
  output logic        counts_m_axil_rready,
  output logic        counts_reply_data,
  output logic        counts_reply_last,
  output logic        counts
);

  logic reset, live = 1'b0, stays, write_stays, read_stays;
  logic begun = 1'b0, write;
  logic [2:0] place;  // of the next byte in its access
  logic [7:0] count;  // accesses that have come whole
  logic address_taken = 1'b0, data_taken = 1'b0, read_taken = 1'b0;
  logic whole, well_formed, between, answers;
  assign whole = place == (write ? 3'd5 : 3'd1);
  assign well_formed = begun ? request_write == write && (!request_last || whole)
      && (request_last || !whole || count != 8'(Accesses - 1)) : !request_last;
  assign between = ~begun & ~request_valid;
  assign answers = (~m_axil_bvalid | (address_taken & data_taken)) & (~m_axil_rvalid | read_taken);
  assign holds = rst
      | (stays & write_stays & read_stays & (~request_valid | well_formed) & (~forget | between) & answers);
  assign reset = rst | ~holds;

  always_ff @(posedge clk) begin
    live <= live | reset;
    if (request_valid && request_ready) begin
      begun <= ~request_last;
      write <= request_write;
      place <= !begun || whole ? '0 : place + 3'd1;
      count <= !begun ? '0 : count + 8'(whole);
    end
    if (m_axil_awvalid && m_axil_awready) address_taken <= 1'b1;
    if (m_axil_wvalid && m_axil_wready) data_taken <= 1'b1;
    if (m_axil_arvalid && m_axil_arready) read_taken <= 1'b1;
    if (m_axil_bvalid && m_axil_bready) {address_taken, data_taken} <= '0;
    if (m_axil_rvalid && m_axil_rready) read_taken <= 1'b0;
    if (reset) {begun, address_taken, data_taken, read_taken} <= '0;
  end

  offer_stays #(.Width(10)) u_request (
    .clk, .rst, .reset, .valid(request_valid), .ready(request_ready),
    .word({request_write, request_last, request_data}), .holds(stays)
  );
  offer_stays #(.Width(2)) u_written (
    .clk, .rst, .reset, .valid(m_axil_bvalid), .ready(m_axil_bready), .word(m_axil_bresp), .holds(write_stays)
  );
  offer_stays #(.Width(34)) u_read (
    .clk, .rst, .reset, .valid(m_axil_rvalid), .ready(m_axil_rready), .word({m_axil_rresp, m_axil_rdata}),
    .holds(read_stays)
  );

  assign counts = live & ~reset;
  assign counts_m_axil_awaddr = counts & m_axil_awvalid;
  assign counts_m_axil_wdata = counts & m_axil_wvalid;
  assign counts_m_axil_araddr = counts & m_axil_arvalid;
  assign counts_m_axil_bready = counts & m_axil_bvalid;
  assign counts_m_axil_rready = counts & m_axil_rvalid;
  assign {counts_reply_data, counts_reply_last} = {2{counts & reply_valid}};

endmodule

`default_nettype wire
