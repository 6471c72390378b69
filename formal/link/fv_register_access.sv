// SPDX-License-Identifier: Apache-2.0
// fv_register_access: each access of a request once, one at a time, with its own address and value, in its clock; none
// behind one that was refused, none above the width, none of a request that is repeated. The reply has kind, number,
// accesses done and the values that the port gave; a repeated one is the same. AXI rules; stable under stall.
//
// What comes out of the memory is free, but that a word stays until the next is read: td_ram is proven by itself. Here
// each value read goes to the word of its access, and each word leaves from there.

parameter int AddressWidth = 4, Accesses = 2;

// A request as it comes.
logic takes, begun, write, known, idle_request, same, closed;
logic [7:0] number;
logic [2:0] place;
logic [15:0] address;
logic [31:0] value;
// due: an access has come whole. open: it is offered, or waits for its answer.
logic due, open, address_left, data_left, read_left, beyond, answered, refused;
logic [7:0] done;
logic [9:0] sent, size;
assign takes = request_valid & request_ready;
assign same = known & request_write == write & request_data == number;
assign beyond = address >= 16'(1 << AddressWidth);
assign answered = (m_axil_bvalid & m_axil_bready) | (m_axil_rvalid & m_axil_rready);
assign refused = write ? m_axil_bresp != '0 : m_axil_rresp != '0;
assign size = write ? 10'd3 : 10'd3 + 10'(done) * 10'd4;

logic replies, was_read;
logic [7:0] word_read;
logic [9:0] value_byte;  // place of the next byte among the values
logic [31:0] word_before;
assign replies = closed & ~due & ~open;
assign value_byte = sent - 10'd3;

always_ff @(posedge clk) begin
  due <= 1'b0;
  if (takes) begin
    begun <= ~request_last;
    closed <= request_last;
    if (!begun) begin
      place <= '0;
      known <= 1'b1;
      write <= request_write;
      number <= request_data;
      idle_request <= same;
      if (!same) done <= '0;
    end else begin
      if (place == 3'd0) address[7:0] <= request_data;
      if (place == 3'd1) address[15:8] <= request_data;
      for (int n = 0; n < 4; n++) if (32'(place) == n + 2) value[8*n+:8] <= request_data;
      place <= place + 3'd1;
      if (place == (write ? 3'd5 : 3'd1)) begin
        place <= '0;
        due <= ~idle_request;
      end
    end
  end
  if (due) begin
    if (beyond) idle_request <= 1'b1;
    open <= ~beyond;
  end
  if (m_axil_awready) address_left <= 1'b0;
  if (m_axil_wready) data_left <= 1'b0;
  if (m_axil_arready) read_left <= 1'b0;
  if (due) {address_left, data_left, read_left} <= beyond ? '0 : {write, write, !write};
  if (answered) begin
    open <= 1'b0;
    if (refused) idle_request <= 1'b1;
    else done <= done + 8'd1;
  end
  if (reply_valid && reply_ready) begin
    sent <= sent + 10'd1;
    if (reply_last) begin
      sent <= '0;
      closed <= 1'b0;
    end
  end
  was_read <= dut.u_values.read_en;
  word_before <= dut.word;
  if (dut.u_values.read_en) word_read <= 8'(dut.u_values.read_address);
  if (forget) known <= 1'b0;
  if (rst) begin
    {begun, known, closed, due, open, address_left, data_left, read_left} <= '0;
    sent <= '0;
  end
end
always_comb if (!was_read) assume (dut.word == word_before);

offer_stays u_reply_ (.*);
always_comb begin
  if (started) begin
    waits_for_its_end: assert (request_ready == (!due && !open && !closed));
    offered_in_its_clock: assert ({m_axil_awvalid, m_axil_wvalid, m_axil_arvalid}
        == {address_left, data_left, read_left});
    answer_taken: assert ({m_axil_bready, m_axil_rready} == {open && write, open && !write});
    if (m_axil_awvalid) its_own_write: assert (16'(m_axil_awaddr) == address);
    if (m_axil_wvalid) its_own_value: assert (m_axil_wdata == value);
    if (m_axil_arvalid) its_own_read: assert (16'(m_axil_araddr) == address);
    reply_in_its_clock: assert (reply_valid == replies);
    if (reply_valid) begin
      as_long_as_its_values: assert (reply_last == (sent == size - 10'd1));
      if (sent == 10'd0) its_kind: assert (reply_data == (write ? 8'h84 : 8'h83));
      if (sent == 10'd1) its_number: assert (reply_data == number);
      if (sent == 10'd2) accesses_done: assert (reply_data == done);
      if (sent > 10'd2) begin
        value_of_its_access: assert (word_read == value_byte[9:2]);
        byte_of_its_value: assert (reply_data == 8'(dut.word >> {value_byte[1:0], 3'd0}));
      end
    end
    values_kept: assert (dut.u_values.write_en == (m_axil_rvalid && m_axil_rready));
    if (dut.u_values.write_en) begin
      word_of_its_access: assert (8'(dut.u_values.write_address) == done && dut.u_values.write_data == m_axil_rdata);
    end

    some_refused: cover (reply_last && reply_valid && idle_request && done == 8'd1 && write);
    longest: cover (reply_last && reply_valid && done == 8'(Accesses) && !write);
    repeated: cover (takes && !begun && same && done == 8'd1);
  end
end

bind dut.u_values ram_check #(.Depth(Depth)) u_check (.*);

// Protocol: requests are whole: a number, then 1 to Accesses accesses, all of one kind; `forget` comes between them.
// The port answers an access once, after it was taken. What is offered stays until it is taken. The ready of an
// answer counts while it is offered.
module protocol_register_access;
  logic stays, write_stays, read_stays;
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
  always_ff @(posedge clk) begin
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
