// SPDX-License-Identifier: Apache-2.0
// fv_depth_signature: the signature is that of the codes of the last whole frame, one step for each code, two clocks
// behind them, and 0 from a clear, a reset or a start of a frame to a frame's end.

parameter int Width = 12, Lanes = 4;

logic [31:0] sum, next, shown;
logic complete;
always_comb begin
  next = in_frame_start ? '1 : sum;
  for (int n = 0; n < Lanes; n++) next = signature_step(next, {{(32 - Width) {in_data[n*Width+Width-1]}}, in_data[n*Width+:Width]});
end
logic took, took_end, begun, known;  // known: a frame began since the reset
always_ff @(posedge clk) begin
  if (en && in_valid) sum <= next;
  took <= en & in_valid;
  took_end <= in_frame_end;
  if (took) complete <= took_end;
  if (en && in_valid && in_frame_start) begun <= 1'b1;
  if (took) known <= begun;
  if (clear || rst) complete <= 1'b0;
  if (rst) {begun, known, took} <= '0;
end
always_ff @(posedge clk) if (took) shown <= sum;

always_comb begin
  if (started) begin
    if (!complete || known) that_of_the_codes: assert (signature == (complete ? shown : '0));
    again: cover (complete && took && took_end && shown != sum);
    cleared: cover (!complete && shown != '0 && !took);
  end
end
