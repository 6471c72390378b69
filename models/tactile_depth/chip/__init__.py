# SPDX-License-Identifier: Apache-2.0
"""The hardware bit for bit: a folder for each unit of hdl/, the model of a core X of unit F is F/X.py."""
