// SPDX-License-Identifier: Apache-2.0
// setting_registers: the registers that software alone writes, and that hold what was written.
//
// Register n has the offset, the bits and the value after a reset of word n of Offsets, Masks and Resets; by default
// they are those of registers/tactile_depth.rdl. A write replaces the bytes that are strobed, and shows in the next
// cycle. read_data is the word at read_offset in the same cycle, 0 where there is none.
// Model: models/tactile_depth/chip/registers/setting_registers.py.

`default_nettype none

module setting_registers
  import td_register_map_pkg::*;
#(
  parameter int Count = Settings,
  parameter logic [32*Count-1:0] Offsets = SettingOffsets,
  parameter logic [32*Count-1:0] Masks = SettingMasks,
  parameter logic [32*Count-1:0] Resets = SettingResets
) (
  input  wire                    clk,
  input  wire                    rst,
  input  wire                    write,
  input  wire  [31:0]            write_offset,
  input  wire  [31:0]            write_ones,  // the data, 0 in bytes without strobe
  input  wire  [31:0]            write_mask,  // ones in bytes with strobe
  input  wire  [31:0]            read_offset,
  output logic [31:0]            read_data,
  output logic [Count-1:0][31:0] settings
);

  always_ff @(posedge clk) begin
    for (int n = 0; n < Count; n++) begin
      if (write && write_offset == Offsets[32*n+:32]) begin
        settings[n] <= (write_ones | (settings[n] & ~write_mask)) & Masks[32*n+:32];
      end
      if (rst) settings[n] <= Resets[32*n+:32];
    end
  end

  always_comb begin
    read_data = '0;
    for (int n = 0; n < Count; n++) begin
      if (read_offset == Offsets[32*n+:32]) read_data = read_data | settings[n];
    end
  end

endmodule

`default_nettype wire
