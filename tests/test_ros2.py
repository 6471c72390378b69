# SPDX-License-Identifier: Apache-2.0
"""examples/ros2: exact conversion of messages, and the node with substitutes for the modules of ROS."""

import importlib
import math
import sys
from dataclasses import replace
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from commands.common.repository import ROOT

FOLDER = ROOT / "examples" / "ros2"


@pytest.fixture
def conversions(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module("tactile_depth_ros.conversions")


@pytest.mark.parametrize("padding", [0, 5])
def test_pictures_are_read_in_rgb_without_their_padding(conversions: Any, padding: Any) -> None:
    image = np.random.default_rng(1).integers(0, 256, (4, 6, 3)).astype(np.uint8)
    for encoding, sent in (("rgb8", image), ("bgr8", image[..., ::-1])):
        rows = np.full((4, 18 + padding), 77, np.uint8)
        rows[:, :18] = sent.reshape(4, 18)
        read = conversions.picture(4, 6, 18 + padding, encoding, rows.tobytes())
        np.testing.assert_array_equal(read, image)
        assert read.flags.c_contiguous


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ((4, 6, 18, "mono8", bytes(72)), "encoding 'mono8': accepted are rgb8, bgr8"),
        ((4, 6, 17, "rgb8", bytes(68)), "68 bytes, step 17 for 6 x 4 pixels"),
        ((4, 6, 18, "rgb8", bytes(71)), "71 bytes, step 18"),
        ((0, 6, 18, "rgb8", b""), "0 bytes"),
    ],
)
def test_a_message_that_is_no_picture_is_refused(conversions: Any, fields: Any, message: Any) -> None:
    with pytest.raises(td.InputError, match=message):
        conversions.picture(*fields)


def test_heights_and_points_are_in_metres(conversions: Any, pipeline: Any, ball: Any) -> None:
    result = pipeline(ball.image)
    depth = conversions.depth_image(result)
    assert (depth["height"], depth["width"], depth["step"], depth["encoding"]) == (96, 128, 512, "32FC1")
    height = np.frombuffer(depth["data"], "<f4").reshape(96, 128)
    np.testing.assert_allclose(height, result.height_mm / 1000, rtol=1e-6, atol=1e-12)
    cloud = conversions.points(result)
    assert (cloud["height"], cloud["width"], cloud["point_step"], cloud["row_step"]) == (96, 128, 12, 1536)
    xyz = np.frombuffer(cloud["data"], "<f4").reshape(96, 128, 3)
    np.testing.assert_array_equal(xyz[..., 2], height)
    pitch = result.pixel_pitch_mm / 1000
    np.testing.assert_allclose(xyz[3, 5, :2], [5 * pitch, 3 * pitch], rtol=1e-6)
    assert cloud["is_dense"]
    wide = conversions.points(replace(result, pixel_aspect=1.5))
    np.testing.assert_allclose(np.frombuffer(wide["data"], "<f4").reshape(xyz.shape), xyz * [1.5, 1, 1], rtol=1e-6)


def test_the_contact_is_in_si_units_in_the_documented_order(conversions: Any, pipeline: Any, ball: Any) -> None:
    result = pipeline(ball.image)
    numbers = dict(zip(conversions.CONTACT_FIELDS, conversions.contact(result), strict=True))
    contact, pitch = result.contact, result.pixel_pitch_mm / 1000
    assert numbers["touching"] == 1
    assert numbers["peak_m"] == pytest.approx(contact.peak_mm / 1e3)
    assert (numbers["peak_y_m"], numbers["peak_x_m"]) == pytest.approx([pitch * place for place in contact.peak_px])
    assert numbers["area_m2"] == pytest.approx(contact.area_mm2 / 1e6)
    assert numbers["volume_m3"] == pytest.approx(contact.volume_mm3 / 1e9)
    centroid = (numbers["centroid_y_m"], numbers["centroid_x_m"])
    assert centroid == pytest.approx([pitch * place for place in contact.centroid_px])
    untouched = dict(zip(conversions.CONTACT_FIELDS, conversions.contact(pipeline(ball.reference)), strict=True))
    assert untouched["touching"] == untouched["area_m2"] == 0
    assert math.isnan(untouched["centroid_x_m"])
    readme = (FOLDER / "README.md").read_text()
    assert ", ".join(conversions.CONTACT_FIELDS).replace("touching", "touching (0 or 1)").replace(
        "peak_m,", "peak_m (depth),"
    ) in " ".join(readme.split())


# The node.


class Message(SimpleNamespace):
    """Message that takes any field."""


class Node:
    """Substitute for rclpy.node.Node: parameters by name, published messages, services by name."""

    parameters: dict = {}  # noqa: RUF012

    def __init__(self, _: Any) -> None:
        self.published: dict[Any, Any] = {}
        self.services: dict[Any, Any] = {}
        self.errors: list[Any] = []
        self.warnings: list[str] = []

    def declare_parameter(self, name: str, default: Any) -> Any:
        return SimpleNamespace(value=self.parameters.get(name, default))

    def create_publisher(self, _: Any, topic: str, __: Any) -> Any:
        return SimpleNamespace(publish=self.published.setdefault(topic, []).append)

    def create_subscription(self, _: Any, topic: str, callback: Any, __: Any) -> None:
        assert topic == "image"
        self.receive = callback

    def create_service(self, _: Any, name: str, callback: Any) -> None:
        self.services[name] = callback

    def get_logger(self) -> Any:
        return SimpleNamespace(
            info=lambda _: None,
            error=lambda text, **_: self.errors.append(text),
            warning=lambda text, **_: self.warnings.append(text),
        )


@pytest.fixture
def make_node(monkeypatch: pytest.MonkeyPatch, conversions: Any) -> Any:
    """Return a function that imports the node with substitutes for ROS and starts it with parameters."""
    names = {
        "rclpy": {},
        "rclpy.node": {"Node": Node},
        "rclpy.qos": {"qos_profile_sensor_data": None},
        "sensor_msgs": {},
        "sensor_msgs.msg": dict.fromkeys(("Image", "PointCloud2", "PointField"), Message),
        "std_msgs": {},
        "std_msgs.msg": {
            "Float32MultiArray": lambda data: Message(data=data, layout=Message()),
            "MultiArrayDimension": Message,
        },
        "std_srvs": {},
        "std_srvs.srv": {"Trigger": SimpleNamespace(Response=Message)},
    }
    for name, content in names.items():
        module = ModuleType(name)
        module.__dict__.update(content)  # type: ignore[call-overload]
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.delitem(sys.modules, "tactile_depth_ros.tactile_depth_node", raising=False)
    module = importlib.import_module("tactile_depth_ros.tactile_depth_node")

    def make(**parameters: Any) -> Any:
        monkeypatch.setattr(Node, "parameters", parameters)
        return module.TactileDepthNode()

    return make


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory, ball: Any) -> Any:
    folder = tmp_path_factory.mktemp("sensor")
    ball.sensor.save(folder / "sensor.npz")
    Image.fromarray(ball.reference).save(folder / "background.png")
    return folder


def message(image: np.ndarray, encoding: str = "rgb8") -> Any:
    rows, columns = image.shape[:2]
    sent = image if encoding == "rgb8" else image[..., ::-1]
    return Message(
        header="header", height=rows, width=columns, step=3 * columns, encoding=encoding, data=sent.tobytes()
    )


def test_the_node_publishes_depth_with_the_header_of_the_picture(
    make_node: Any, files: Any, conversions: Any, pipeline: Any, ball: Any
) -> None:
    node = make_node(calibration=f"{files}/sensor.npz", reference=f"{files}/background.png")
    node.receive(message(ball.image, "bgr8"))
    assert not node.errors
    result = pipeline(ball.image)
    (height,), (points,), (contact,) = (node.published[topic] for topic in ("height", "points", "contact"))
    assert height.header == points.header == "header"
    assert height.data == conversions.depth_image(result)["data"]
    assert points.data == conversions.points(result)["data"]
    assert [(field.name, field.offset, field.datatype) for field in points.fields] == [
        ("x", 0, 7), ("y", 4, 7), ("z", 8, 7)
    ]  # fmt: skip
    assert contact.data == conversions.contact(result)
    assert contact.layout.dim[0].label.split(",")[0] == "touching"


def test_the_first_frames_become_the_reference(
    make_node: Any, files: Any, conversions: Any, ball: Any, pipeline: Any
) -> None:
    node = make_node(calibration=f"{files}/sensor.npz")
    for _ in range(8):
        node.receive(message(ball.reference))
    node.receive(message(ball.image))
    assert node.published["height"][-1].data == conversions.depth_image(pipeline(ball.image))["data"]
    assert len(node.published["height"]) == 2  # the eighth and the last


def test_the_services_capture_from_the_pictures_that_follow(
    make_node: Any, files: Any, conversions: Any, ball: Any
) -> None:
    node = make_node(calibration=f"{files}/sensor.npz", reference=f"{files}/background.png")
    weaker = np.rint(ball.reference * 0.9).astype(np.uint8)
    answer = node.services["capture_reference"](None, Message())
    assert answer.success
    for _ in range(8):
        node.receive(message(weaker))
    expected = td.Pipeline(ball.sensor, ball.reference)
    expected.capture_reference(np.stack([weaker] * 8))
    expected.capture_zero(np.stack([weaker] * 8))
    node.receive(message(ball.image))
    assert node.published["height"][-1].data == conversions.depth_image(expected(ball.image))["data"]
    assert not node.errors


def test_a_bad_picture_is_logged_and_the_node_goes_on(make_node: Any, files: Any, ball: Any) -> None:
    node = make_node(calibration=f"{files}/sensor.npz", reference=f"{files}/background.png")
    node.receive(Message(header="", height=1, width=1, step=1, encoding="mono8", data=b"0"))
    assert node.errors == ["encoding 'mono8': accepted are rgb8, bgr8: convert it with image_proc"]
    node.receive(message(ball.image))
    assert len(node.published["height"]) == 1


def test_doubts_of_a_picture_are_logged(make_node: Any, files: Any, ball: Any) -> None:
    node = make_node(calibration=f"{files}/sensor.npz", reference=f"{files}/background.png")
    node.receive(message(ball.image))
    assert not node.warnings
    bright = ball.image.copy()
    bright[:, : bright.shape[1] // 50] = 255
    with pytest.warns(td.InputWarning):
        node.receive(message(bright))
    (warning,) = node.warnings
    assert "of its pixels are clipped" in warning


def test_a_reference_of_no_known_sensor_is_tried_again(make_node: Any, ball: Any) -> None:
    node = make_node()
    for _ in range(8):
        node.receive(message(ball.reference))
    (error,) = node.errors
    assert "looks like no sensor with a built-in calibration" in error
    mini = np.kron(td.load("gelsight-mini").lighting * 90, np.ones((60, 80, 1))).clip(0, 255).astype(np.uint8)  # type: ignore[operator]
    for _ in range(8):
        node.receive(message(mini))
    assert len(node.published["height"]) == 1


def test_all_files_of_the_package_agree_on_its_name() -> None:
    name = "tactile_depth_ros"
    assert f"<name>{name}</name>" in (FOLDER / "package.xml").read_text()
    assert (FOLDER / "resource" / name).is_file()
    assert f"lib/{name}" in (FOLDER / "setup.cfg").read_text()
    assert f'package="{name}"' in (FOLDER / "launch" / "tactile_depth.launch.py").read_text()
