# SPDX-License-Identifier: Apache-2.0
"""Package of the ROS 2 node, as ament_python wants it."""

from setuptools import setup

NAME = "tactile_depth_ros"

setup(
    name=NAME,
    version="0.2.1",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", ["launch/tactile_depth.launch.py"]),
    ],
    install_requires=["setuptools", "tactile-depth"],
    zip_safe=True,
    maintainer="The authors of tactile-depth",
    maintainer_email="maintainers@tactile-depth.invalid",
    description="Depth of a visuotactile sensor as ROS 2 topics",
    license="Apache-2.0",
    entry_points={"console_scripts": [f"tactile_depth_node = {NAME}.tactile_depth_node:main"]},
)
