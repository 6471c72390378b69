# SPDX-License-Identifier: Apache-2.0
"""Depth of a visuotactile sensor as ROS 2 topics."""
