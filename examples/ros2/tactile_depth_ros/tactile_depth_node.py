# SPDX-License-Identifier: Apache-2.0
"""Node: pictures of the sensor in; height, points and contact out."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Image, PointCloud2, PointField
from std_msgs.msg import Float32MultiArray, MultiArrayDimension
from std_srvs.srv import Trigger

import tactile_depth as td
from tactile_depth.pictures.frames import read_picture
from tactile_depth_ros import conversions

FRAMES = 8  # of a capture
CAPTURES = ("reference", "zero")


class TactileDepthNode(Node):
    """Topics `image` to `height`, `points`, `contact`; services `capture_reference` and `capture_zero`."""

    def __init__(self) -> None:
        super().__init__("tactile_depth")
        calibration = self.declare_parameter("calibration", "").value
        self._crop = self.declare_parameter("crop", "").value or None
        self._sensor = td.load(calibration) if calibration else None
        names = {"threshold_mm": 0.07, "area_threshold_mm": 0.3}
        self._thresholds = {name: self.declare_parameter(name, value).value for name, value in names.items()}
        self._arithmetic = self.declare_parameter("arithmetic", "chip").value
        path = self.declare_parameter("reference", "").value
        self._pipeline = None
        self._capture, self._collected = "", []
        if path:
            self._make_pipeline(read_picture(Path(path)))
        else:
            self._capture = CAPTURES[0]
            self.get_logger().info(f"do not touch the sensor: its first {FRAMES} frames become the reference")
        self._height = self.create_publisher(Image, "height", qos_profile_sensor_data)
        self._points = self.create_publisher(PointCloud2, "points", qos_profile_sensor_data)
        self._contact = self.create_publisher(Float32MultiArray, "contact", 10)
        self.create_subscription(Image, "image", self._receive, qos_profile_sensor_data)
        for name in CAPTURES:
            self.create_service(Trigger, f"capture_{name}", lambda _, response, name=name: self._ask(name, response))

    def _make_pipeline(self, reference: np.ndarray) -> None:
        """Make the pipeline, with the calibration that was named or the built-in one that the reference looks like."""
        first = reference if reference.ndim == 3 else reference[0]
        sensor = self._sensor or td.identify(first, crop=self._crop)
        options = {**self._thresholds, "crop": self._crop, "arithmetic": self._arithmetic}
        self._pipeline = td.Pipeline(sensor, reference, **options)
        self.get_logger().info(f"calibration {sensor.name}, {self._pipeline.grid[1]} x {self._pipeline.grid[0]} pixels")

    def _ask(self, name: str, response: Trigger.Response) -> Trigger.Response:
        """Answer at once; the capture is taken from the pictures that follow."""
        self._capture, self._collected = name, []
        response.success = True
        response.message = f"the next {FRAMES} frames: do not touch the sensor"
        return response

    def _receive(self, message: Image) -> None:
        try:
            image = conversions.picture(message.height, message.width, message.step, message.encoding, message.data)
            if self._capture:
                self._collect(image)
            if self._pipeline is not None:
                self._publish(message.header, self._pipeline(image))
        except td.InputError as error:
            self.get_logger().error(str(error), throttle_duration_sec=1.0)

    def _collect(self, image: np.ndarray) -> None:
        """Keep a picture without contact; capture when there are enough of one size."""
        same = [kept for kept in self._collected if kept.shape == image.shape]
        self._collected = [*same, image]
        if len(self._collected) < FRAMES:
            return
        images, name = np.stack(self._collected), self._capture
        self._collected = []
        if self._pipeline is None:
            self._make_pipeline(images)  # where it cannot be made, the next pictures are tried
            self._capture = ""
            return
        self._capture = ""
        if name == CAPTURES[0]:
            self._pipeline.capture_reference(images)
        self._pipeline.capture_zero(images)  # depth at rest depends on the reference
        self.get_logger().info(f"captured the {name}")

    def _publish(self, header: object, result: td.Result) -> None:
        if result.warnings:
            self.get_logger().warning("; ".join(result.warnings), throttle_duration_sec=1.0)
        self._height.publish(Image(header=header, **conversions.depth_image(result)))
        fields = [
            PointField(name=name, offset=4 * index, datatype=conversions.FLOAT32, count=1)
            for index, name in enumerate(conversions.POINT_FIELDS)
        ]
        self._points.publish(PointCloud2(header=header, fields=fields, **conversions.points(result)))
        numbers = Float32MultiArray(data=conversions.contact(result))
        size = len(conversions.CONTACT_FIELDS)
        numbers.layout.dim = [MultiArrayDimension(label=",".join(conversions.CONTACT_FIELDS), size=size, stride=size)]
        self._contact.publish(numbers)


def main() -> None:
    """Run the node until it is interrupted."""
    rclpy.init()
    try:
        node = TactileDepthNode()
    except td.InputError as error:
        rclpy.try_shutdown()
        sys.exit(f"tactile_depth: {error}")
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
