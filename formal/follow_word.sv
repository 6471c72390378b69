// SPDX-License-Identifier: Apache-2.0
// follow_word: says when a group of words (a row, a burst, a frame) is due behind a core, and holds an arbitrary word
// of it to its place. `close` is the event in which the latency is counted: the group's first word is due Latency
// enabled clocks later, and its Words words follow each other. Groups close in the order in which they leave.

`default_nettype none

module follow_word #(
  parameter int Width   = 1,
  parameter int Words   = 8,
  parameter int Latency = 2,
  localparam int PlaceWidth = $clog2(Words)
) (
  input  logic                  clk,
  input  logic                  rst,
  input  logic                  en,
  input  logic                  pick,      // free: follow the word that is present, if none is followed
  input  logic                  in_word,   // a word is present
  input  logic                  in_first,  // of a new group; one that has not closed is given up
  input  logic                  in_closed, // its group closed before
  input  logic [PlaceWidth-1:0] in_place,  // where it shall leave, counted from the group's first
  input  logic [Width-1:0]      in_data,
  input  logic                  close,
  output logic                  due,       // a group's first word shall be present
  output logic                  present,   // a word shall be present
  output logic [PlaceWidth-1:0] place,
  output logic                  watched,   // the word followed shall be present,
  output logic [Width-1:0]      value      // and be this
);

  // Groups that closed and groups that came out, modulo 4; at most two are on their way.
  logic [1:0] closed, begun, begun_q, group, group_of_word;
  logic [Latency-1:0] close_q;
  logic [PlaceWidth-1:0] next_place, place_followed;
  logic running, following;
  assign due = close_q[Latency-1];
  assign present = due | running;
  assign place = due ? '0 : next_place;
  assign begun = begun_q + 2'(due);
  assign group_of_word = closed - 2'(in_closed);
  assign watched = following & present & (2'(begun - 2'd1) == group) & (place == place_followed);

  always_ff @(posedge clk) begin
    if (en) begin
      close_q <= Latency'({close_q, close});
      closed <= closed + 2'(close);
      begun_q <= begun;
      next_place <= place + PlaceWidth'(1);
      running <= present & (place != PlaceWidth'(Words - 1));
      if (!following) begin
        following <= pick & in_word;
        group <= group_of_word;
        place_followed <= in_place;
        value <= in_data;
      end else if (watched || (in_first && closed == group)) begin
        following <= 1'b0;
      end
    end
    if (rst) begin
      close_q <= '0;
      closed <= '0;
      begun_q <= '0;
      running <= 1'b0;
      following <= 1'b0;
    end
  end

endmodule

`default_nettype wire
