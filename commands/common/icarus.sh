#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs Icarus Verilog with the system's package manager when it is missing, or says how.
command -v iverilog >/dev/null && exit 0

install="apt-get install -y iverilog"
if command -v apt-get >/dev/null; then
  sudo=
  [ "$(id -u)" -eq 0 ] || sudo="sudo -n"
  echo "installing Icarus Verilog (once) .."
  { $sudo apt-get update -qq && $sudo $install -qq; } >/dev/null 2>&1 && exit 0
  install="sudo apt-get update && sudo $install"
else
  install="the package manager of this system to install Icarus Verilog (iverilog)"
fi
echo "Icarus Verilog is missing and could not be installed: run $install" >&2
exit 2
