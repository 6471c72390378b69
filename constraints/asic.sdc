# SPDX-License-Identifier: Apache-2.0
# Timing of tactile_depth as an ASIC. One number to change: the clock period in ns. `make asic CLOCK_MHZ=..` sets it first.

if {![info exists period_ns]} {
  set period_ns 10.0
}

create_clock -name clk -period $period_ns [get_ports clk]

# Every pin has a fifth of the period outside: before the inputs, after the outputs.
set outside_ns [expr {0.2 * $period_ns}]
foreach port {rst cold_rst s_axis_tdata* s_axis_tvalid s_axis_tlast s_axis_tuser m_axis_tready m_event_tready s_axil_awaddr*
              s_axil_a*prot* s_axil_awvalid s_axil_w*data* s_axil_wstrb* s_axil_wvalid s_axil_bready s_axil_araddr* s_axil_arvalid
              s_axil_rready} {
  set_input_delay $outside_ns -clock clk [get_ports $port]
}
set_output_delay $outside_ns -clock clk [all_outputs]
