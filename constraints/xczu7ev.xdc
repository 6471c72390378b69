# SPDX-License-Identifier: Apache-2.0
# tactile_depth by itself on the XCZU7EV of a ZCU104, for constraints/xczu7ev_ooc.tcl. NOT RUN HERE: no Vivado.
# Names are those of hdl/tactile_depth.sv; the clock is the published design's.

create_clock -name clk -period 6.024 [get_ports clk]

# Neighbours register their outputs and inputs; a fifth of the clock is for the way to and from them.
set_input_delay -clock clk 1.205 [get_ports -filter {DIRECTION == IN && NAME != "clk"}]
set_output_delay -clock clk 1.205 [get_ports -filter {DIRECTION == OUT}]

# Out of context the clock comes from a buffer that is not there.
set_property HD.CLK_SRC BUFGCE_X0Y0 [get_ports clk]
