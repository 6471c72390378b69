# SPDX-License-Identifier: Apache-2.0
"""Starts the node: ros2 launch tactile_depth_ros tactile_depth.launch.py image:=/camera/image_raw reference:=..."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

PARAMETERS = {
    "calibration": ("", str),
    "reference": ("", str),
    "crop": ("", str),
    "threshold_mm": ("0.07", float),
    "area_threshold_mm": ("0.3", float),
    "arithmetic": ("chip", str),
}


def generate_launch_description() -> LaunchDescription:
    """Declare the topic of the pictures and the node's parameters as arguments."""
    arguments = [DeclareLaunchArgument("image", default_value="/image_raw")]
    arguments += [DeclareLaunchArgument(name, default_value=value) for name, (value, _) in PARAMETERS.items()]
    values = {
        name: ParameterValue(LaunchConfiguration(name), value_type=kind) for name, (_, kind) in PARAMETERS.items()
    }
    node = Node(
        package="tactile_depth_ros",
        executable="tactile_depth_node",
        namespace="tactile",
        parameters=[values],
        remappings=[("image", LaunchConfiguration("image"))],
    )
    return LaunchDescription([*arguments, node])
