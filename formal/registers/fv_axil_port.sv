// SPDX-License-Identifier: Apache-2.0
// fv_axil_port: the rules of AXI4-Lite, and each transaction once, with its own words, in its own clock.
//
// Nothing is assumed of the client, the registers or reset.

assign allowed = 1'b1;
// Half a write that was taken; a write that took effect, whose response has not left.
logic has_address, has_data, answered;
logic [AddressWidth-1:0] address;
logic [35:0] word;
logic refused, read_busy, answer_refused, read_due, write_was, response_waits, answer_waits;
logic [2:0] until_late;  // clocks
logic [31:0] answer;
logic [1:0] last_bresp, last_rresp;
logic [31:0] last_rdata;
logic read_taken;  // in the clock before
logic [AddressWidth-3:0] taken_address;
logic [31:0] strobed;
always_comb for (int n = 0; n < 32; n++) strobed[n] = word[32 + n / 8];
always_ff @(posedge clk) begin
  if (s_axil_awvalid && s_axil_awready) {has_address, address} <= {1'b1, s_axil_awaddr};
  if (s_axil_wvalid && s_axil_wready) {has_data, word} <= {1'b1, s_axil_wstrb, s_axil_wdata};
  write_was <= write;
  if (write) {answered, refused} <= {1'b1, write_refused};
  if (s_axil_bvalid && s_axil_bready) {has_address, has_data, answered} <= '0;

  read_due <= (read && !read_late) || until_late == 3'd1;
  read_taken <= s_axil_arvalid & s_axil_arready;
  taken_address <= s_axil_araddr[AddressWidth-1:2];
  if (s_axil_arvalid && s_axil_arready) read_busy <= 1'b1;
  if (s_axil_rvalid && s_axil_rready) read_busy <= 1'b0;
  until_late <= read && read_late ? 3'd4 : until_late == 3'd0 ? 3'd0 : until_late - 3'd1;
  if (until_late == 3'd1) {answer, answer_refused} <= {late_data, late_refused};
  else if (read) {answer, answer_refused} <= {read_data, read_refused};

  response_waits <= s_axil_bvalid & ~s_axil_bready;
  answer_waits <= s_axil_rvalid & ~s_axil_rready;
  {last_bresp, last_rdata, last_rresp} <= {s_axil_bresp, s_axil_rdata, s_axil_rresp};
  if (rst) begin
    {has_address, has_data, answered, read_busy, read_taken, read_due, write_was, until_late, response_waits, answer_waits} <= '0;
  end
end

always_comb begin
  nothing_taken_in_reset: assert (!(rst && (s_axil_awready || s_axil_wready || s_axil_arready)));
  if (started) begin
    one_write_in_flight: assert (s_axil_awready == (!has_address && !rst) && s_axil_wready == (!has_data && !rst));
    one_read_in_flight: assert (s_axil_arready == (!read_busy && !rst));
    a_write_when_due: assert (write == (has_address && has_data && !answered && !read_taken && until_late == 3'd0));
    response_when_due: assert (s_axil_bvalid == answered);
    answer_when_due: assert (s_axil_rvalid == (read_busy && !read_taken && until_late == 3'd0));
    read_when_taken: assert (read == read_taken);
    if (write) begin
      its_own_register: assert (write_offset == 32'({address[AddressWidth-1:2], 2'd0}));
      its_own_bytes: assert (write_mask == strobed && write_ones == (word[31:0] & strobed));
    end
    if (read) register_read: assert (read_offset == 32'({taken_address, 2'd0}));
    if (write_was) its_response: assert (s_axil_bresp == (refused ? 2'd2 : 2'd0));
    if (read_due) its_answer: assert (s_axil_rdata == answer && s_axil_rresp == (answer_refused ? 2'd2 : 2'd0));
    if (response_waits) response_stays: assert (s_axil_bvalid && s_axil_bresp == last_bresp);
    if (answer_waits) begin
      answer_stays: assert (s_axil_rvalid && s_axil_rdata == last_rdata && s_axil_rresp == last_rresp);
    end

    data_first: cover (has_data && !has_address && s_axil_awvalid);
    write_waits_for_a_late_read: cover (has_address && has_data && until_late == 3'd1);
    write_waits_for_a_read: cover (has_address && has_data && !answered && read && !read_late);
    refused_and_stalled: cover (response_waits && refused && answer_waits && answer_refused);
  end
end
