// SPDX-License-Identifier: Apache-2.0
// td_memory_pkg: sizes of distributed memories, for Xilinx; boards/ecp5 has those of an ECP5.

`default_nettype none

package td_memory_pkg;

  // Memories of up to so many bits are distributed: LUTs are then cheaper than a block memory.
  localparam int DistributedBits = 4096;

  // The same where sums follow a word in its cycle, which a block memory gives late, and of tables side by side.
  localparam int LateBits = 4096;

endpackage

`default_nettype wire
