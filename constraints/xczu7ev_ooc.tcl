# SPDX-License-Identifier: Apache-2.0
# tactile_depth by itself through Vivado: resources, routed clock and power of an XCZU7EV. NOT RUN HERE: no Vivado.
#
#   make synth TARGET=xczu7ev PRESET=published SOLVER=tridiagonal OUT=build/synth/mine
#   vivado -mode batch -source constraints/xczu7ev_ooc.tcl -tclargs build/synth/mine
#
# From the folder of `make synth` come parameters.txt, the parameters of the top, and rom/, the tables that $readmemh
# reads. Reports and the checkpoint go to its folder vivado/.

set part xczu7ev-ffvc1156-2-e
set root [file normalize [file join [file dirname [info script]] ..]]
if {$argc != 1 || ![file isfile [file join [lindex $argv 0] parameters.txt]]} {
  puts stderr "xczu7ev_ooc.tcl: give the folder that `make synth` wrote for one configuration: -tclargs build/synth/.."
  exit 2
}
set made [file normalize [lindex $argv 0]]
set reports [file join $made vivado]
file mkdir $reports

set file [open [file join $made parameters.txt]]
set parameters [split [string trim [read $file]]]
close $file

# Packages first. Tables are looked for where Vivado stands.
set sources [lsort [glob [file join $root hdl *.sv] [file join $root hdl * *.sv] [file join $root hdl * * *.sv]]]
foreach source [lsearch -all -inline $sources *_pkg.sv] { read_verilog -sv $source }
foreach source [lsearch -all -inline -not $sources *_pkg.sv] { read_verilog -sv $source }
read_xdc -mode out_of_context [file join $root constraints xczu7ev.xdc]
cd [file join $made rom]

synth_design -top tactile_depth -part $part -mode out_of_context -flatten_hierarchy rebuilt -generic $parameters
report_utilization -hierarchical -file [file join $reports utilization_synthesis.txt]
report_ram_utilization -file [file join $reports memories.txt]

opt_design
place_design
phys_opt_design
route_design
report_utilization -hierarchical -file [file join $reports utilization.txt]
report_timing_summary -file [file join $reports timing.txt]
report_power -file [file join $reports power.txt]
write_checkpoint -force [file join $reports routed.dcp]
