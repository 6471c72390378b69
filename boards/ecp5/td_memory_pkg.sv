// SPDX-License-Identifier: Apache-2.0
// td_memory_pkg: sizes of distributed memories on an ECP5, whose LUTs hold 16 x 4 bits in four.

`default_nettype none

package td_memory_pkg;

  // Memories of up to so many bits are distributed: LUTs are then cheaper than a block memory.
  localparam int DistributedBits = 1024;

  // The same where sums follow a word in its cycle, which a block memory gives late, and of tables side by side.
  localparam int LateBits = 4096;

endpackage

`default_nettype wire
