# SPDX-License-Identifier: Apache-2.0
"""Two runs that write into one folder at once: it holds the files of one of them, and a file is there at any time."""

import json
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
from PIL import Image

from tactile_depth.base import files
from tactile_depth.pictures.frames import read_pictures

NAMES = ["depth.npy", "depth.png", "overview.png"]
RUNS = 50


def write_results(folder: Path, tag: str) -> None:
    for _ in range(RUNS):
        with files.new_files(folder, "report.json", "files") as work:
            for name in NAMES:
                (work / name).write_text(tag)
            (work / "report.json").write_text(json.dumps({"files": NAMES, "tag": tag}))


def write_file(path: Path, tag: str) -> None:
    for _ in range(RUNS):
        with files.workspace(path.parent, (path.name,), guarded=False) as work:
            (work / path.name).write_text(tag)
            files.replace(work, (path.name,), path.parent, guarded=False)


def test_runs_into_one_folder_wait_for_each_other(tmp_path: Path) -> None:
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(partial(write_results, tmp_path), "ab"))
    tag = json.loads((tmp_path / "report.json").read_text())["tag"]
    assert [(tmp_path / name).read_text() for name in NAMES] == [tag] * len(NAMES)
    write_results(tmp_path, "c")


def test_a_file_that_is_replaced_is_there_at_any_time(tmp_path: Path) -> None:
    path = tmp_path / "calibration.npz"
    write_file(path, "a")
    with ThreadPoolExecutor(1) as pool:
        writes = pool.submit(write_file, path, "b")
        while not writes.done():
            assert path.read_text() in ("a", "b")
        writes.result()


def test_results_in_a_folder_of_pictures_are_no_pictures(tmp_path: Path) -> None:
    """A second run on a folder that is also its --out reads what the first did."""
    pixels = np.random.default_rng(1).integers(0, 256, (16, 16, 3), np.uint8)
    Image.fromarray(pixels).save(tmp_path / "press.png")
    write_results(tmp_path, "a")
    assert read_pictures(tmp_path)[0] == ("press.png",)
