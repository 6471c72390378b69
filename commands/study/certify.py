# SPDX-License-Identifier: Apache-2.0
"""`make certify`: the largest value that each node can reach, and a run of the frames that reach it.

Takes the variables of `make sim`, and RTL=0 for no simulation. Exit status: 0 if model and RTL saturate exactly where
the certificate allows it, 1 if not, 2 on bad input.
"""

import dataclasses
import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from commands.common import repository, run_request
from commands.common import simulator as simulation
from commands.common.progress import progress_bar
from commands.common.results import save, written
from commands.common.slopes import slope_response
from commands.common.tabular import Column, shown
from commands.common.variables import Flag
from commands.run import sim
from commands.study.node_bounds import Node, node_bounds
from tactile_depth.base import files
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.gradient_lookup import gradient_codes
from tactile_depth.chip.limits import MODELS
from tactile_depth.chip.tactile_depth import tactile_depth
from tactile_depth.depth.twin import Twin
from tactile_depth.pictures.frames import camera_scale
from tactile_depth.sensor.sensor import Sensor

RESULTS = ("worst.npy", "certificate.json")
BATCH = 8  # frames that the model runs at a time
ROUNDING_STEPS = 4.0  # largest error of a transform, in steps of its word: tests/poisson/transform/test_dst_forward.py


@dataclass(frozen=True)
class Attempt:
    """Frame of a calibration's colours that drives a node as far as any of them can."""

    node: Node
    frame: int  # its position among the frames
    expected: float  # value of the node in exact arithmetic, in its codes


class Peaks(Monitor):
    """Largest magnitude of each node in each frame before clipping, and a flag that it was clipped."""

    def __init__(self, widths: dict[str, int], frames: int) -> None:
        super().__init__()
        self.widths = widths
        self.first = 0  # position of the first frame of the current run of the model
        self.peaks = {node: np.zeros(frames, np.int64) for node in widths}
        self.clips = {node: np.zeros(frames, bool) for node in widths}

    def rounded(self, node: str, values: np.ndarray) -> None:
        flat = values.reshape(len(values), -1)
        high, low = flat.max(axis=1), flat.min(axis=1)
        limit = 1 << (self.widths[node] - 1)
        now = slice(self.first, self.first + len(values))
        self.peaks[node][now] = np.maximum(self.peaks[node][now], np.maximum(high, -low))
        self.clips[node][now] |= (high >= limit) | (low < -limit)


def worst_frames(nodes: list[Node], calibration: Sensor, config: Configuration) -> tuple[np.ndarray, list[Attempt]]:
    """Return for each node the frame that drives it furthest: every pixel has the colour whose slopes contribute most.

    Returns
    -------
    frames : uint8 array (frames, rows, columns, 3), each once
    attempts : list of Attempt, one for each node that any frame moves
    """
    codes = gradient_codes(calibration, config)
    bins = _corners(codes)
    colours = np.stack(np.unravel_index(bins, (256 // config.bin_levels,) * 3), axis=-1)
    colours = (colours * config.bin_levels).astype(np.uint8)
    places: dict[bytes, int] = {}
    frames: list[np.ndarray] = []
    attempts = []
    for node in nodes:
        if not node.reached:
            continue
        gain = slope_response(node.response, config.neumann) @ codes[bins].T  # of each corner at each pixel
        choice = gain.argmax(axis=-1)
        key = choice.astype(np.int32).tobytes()
        if key not in places:
            places[key] = len(frames)
            frames.append(colours[choice])
        attempts.append(Attempt(node, places[key], float(gain.max(axis=-1).sum())))
    return np.stack(frames), attempts


def _corners(codes: np.ndarray) -> np.ndarray:
    """Return the bins on the convex hull of the slopes of a table; for every response one of them contributes most."""
    slopes, bins = np.unique(codes, axis=0, return_index=True)
    try:
        return bins[ConvexHull(slopes).vertices]
    except (QhullError, ValueError):  # all on one line, or fewer than three
        return bins


def check_model(
    frames: np.ndarray, attempts: list[Attempt], nodes: list[Node], peaks: Peaks, coefficient_width: int
) -> list[str]:
    """Compare the model's words for the frames with the certificate; return one line for each difference."""
    order = [node.name for node in nodes]
    # The solve amplifies the lowest mode by pixels / (2 pi^2).
    rounding = ROUNDING_STEPS * frames[0, ..., 0].size / (2 * math.pi**2)
    faults = []

    def clipped_before(name: str, frame: int) -> bool:
        return any(peaks.clips[node][frame] for node in order[: order.index(name)])

    for attempt in attempts:
        name, frame = attempt.node.name, attempt.frame
        if clipped_before(name, frame):
            continue  # the input of this frame did not reach the node
        peak, bound = int(peaks.peaks[name][frame]), attempt.node.slopes / attempt.node.form.lsb
        full = attempt.node.form.limit / attempt.node.form.lsb  # a recursion that clips goes on from there
        expected = min(attempt.expected, full)
        near = rounding + expected / 2**coefficient_width  # a coefficient is rounded too
        if not expected - near <= peak <= bound + near:
            faults.append(f"{name} reached {peak:,}, expected {attempt.expected:,.1f} of {bound:,.1f}")
    for node in nodes:
        for frame in np.flatnonzero(peaks.clips[node.name]).tolist():
            if node.slopes_headroom_bits >= 0 and not clipped_before(node.name, frame):
                faults.append(f"{node.name} saturated, which the certificate excludes")
    return faults


@dataclass(frozen=True)
class Record:
    """Node of the certificate; a headroom without a limit is None, and so is the frame of a node that none moves."""

    node: Annotated[str, Column("node")]
    width: Annotated[int, Column("width")]
    fraction: Annotated[int, Column("fraction")]
    holds: Annotated[float, Column("holds", ".5g")]
    worst_over_slopes: Annotated[float, Column("slopes", ".5g")]
    attained_over_slopes: float
    slopes_headroom_bits: Annotated[float | None, Column("headroom", "+.2f")]
    worst_over_depths: Annotated[float, Column("depths", ".5g")]
    depths_headroom_bits: Annotated[float | None, Column("headroom", "+.2f")]
    worst_frame: int | None
    reached_by_frame: float | None


def record(node: Node, attempts: list[Attempt]) -> Record:
    own = next((attempt for attempt in attempts if attempt.node is node), None)
    slopes, depths = (
        None if bits == math.inf else bits for bits in (node.slopes_headroom_bits, node.depths_headroom_bits)
    )
    form = node.form
    frame, reached = (None, None) if own is None else (own.frame, own.expected * form.lsb)
    over = (node.slopes, node.reached, slopes, node.depths, depths)
    return Record(node.name, form.width, form.fraction, form.limit, *over, frame, reached)


def summary(nodes: list[Node], config: Configuration, pixel_pitch_mm: float) -> list[str]:
    """Return the table as sentences."""
    mm = config.deepest_px * pixel_pitch_mm
    steep = [node for node in nodes if node.slopes_headroom_bits < 0]
    deep = [node for node in nodes if node.depths_headroom_bits < 0]
    lines = [
        f"depth range {mm:.4g} mm, slopes up to {config.gradient_limit:g}; headroom in bits, negative: it saturates",
        f"a depth within the range can saturate {', '.join(node.name for node in deep)}"
        if deep
        else "no depth within the range saturates a node",
        f"{len(steep)} of {len(nodes)} nodes saturate for some slopes, {steep[0].name} first in the stream"
        if steep
        else "no slopes at all saturate a node",
    ]
    loose = [node for node in nodes if node.reached < (1 - 1e-9) * node.slopes]
    if loose:
        lowest = min(loose, key=lambda node: node.reached / node.slopes)
        share = 100 * lowest.reached / lowest.slopes
        lines.append(
            f"{len(nodes) - len(loose)} of {len(nodes)} bounds over slopes are attained; of the others, in the inverse "
            f"row transform, no more than {share:.3g} % was found ({lowest.name}): upper bounds"
        )
    else:
        lines.append("every bound over slopes is attained")
    return lines


def cost_of_worst(config: Configuration, pixel_pitch_mm: float) -> str:
    """Return the cost of a depth range that no slopes can leave, against the default one."""
    default = dataclasses.replace(config, depth_range_px=None)
    bits = math.log2(config.depth_lsb_px / default.depth_lsb_px)
    nm = [1e6 * pixel_pitch_mm * each.depth_lsb_px for each in (config, default)]
    return f"depth comes in steps of {nm[0]:.3g} nm, by default {nm[1]:.3g} nm: {bits:.2f} bits of resolution"


def run(request: Annotated[run_request.Request, run_request.chosen()], rtl: Flag = True) -> int:
    """Certify, run the frames, write the results and return the exit status."""
    if rtl:
        simulation.check(request.simulator)
    calibration = run_request.load_sensor(request)
    run_request.check_grid(request)
    grid = Configuration(columns=request.columns, rows=request.rows, solver=request.solver)
    # The certificate holds for all slopes. The colours are those of a table without a reference.
    calibration = dataclasses.replace(calibration, flat_field=None).scaled(camera_scale(calibration, grid))
    pixel_pitch_mm = calibration.pixel_pitch_mm
    # It begins at the slopes, and ends at the depth before the zero offset.
    from_slopes = dataclasses.replace(request, gradient=MODELS[0], zero=None)
    config = run_request.configure(from_slopes, calibration)
    shape = f"{config.rows}x{config.columns}" + (f"-{config.lanes}lanes" if config.lanes > 1 else "")
    name = f"{request.solver}-{request.boundary}-{shape}-{run_request.words_of(config)}"
    if request.deepest_mm == math.inf:
        name += "-worst"
    out = request.out or repository.ROOT / "build" / "certify" / name
    files.check(out, RESULTS)  # refuse bad input before minutes of work
    run_request.announce(request, config)

    shape = "{desc} {percentage:.0f} % {bar} {remaining}"
    with progress_bar(total=1.0, desc="certifying", delay=3, bar_format=shape) as bar:
        nodes = node_bounds(config, bar.update)
    frames, attempts = worst_frames(nodes, calibration, config)
    records = [record(node, attempts) for node in nodes]
    print(shown(Record, records))
    for line in summary(nodes, config, pixel_pitch_mm):
        print(line)
    if request.deepest_mm == math.inf:
        print(cost_of_worst(config, pixel_pitch_mm))

    peaks = Peaks({node.name: node.form.width for node in nodes}, len(frames))
    for first in progress_bar(range(0, len(frames), BATCH), desc="model", delay=3):
        peaks.first = first
        tactile_depth(frames[first : first + BATCH], calibration, config, peaks)
    faults = check_model(frames, attempts, nodes, peaks, config.coefficient_width)
    clipping = sorted(node for node, clips in peaks.clips.items() if clips.any())
    if rtl:
        twin = Twin(calibration, config)
        model, light, clipped = twin.played(frames)
        codes, _, differences = sim.stream(dataclasses.replace(request, repeat=1), twin, frames, light, clipped)
        if (codes != model).any():
            faults.append("RTL differs from the model")
        if sorted(clipped) != clipping:
            faults.append(f"saturated: {', '.join(clipped) or 'nothing'}; expected {clipping}")
        faults += differences
    saturate = f"{'model and RTL saturate' if rtl else 'the model saturates'} {', '.join(clipping) or 'nothing'}"
    print(f"{len(frames)} frames that drive every node furthest, in the colours of {calibration.name}: {saturate}")
    document = {
        **run_request.described(config),
        "depth_range_mm": config.deepest_px * pixel_pitch_mm,
        "gradient_limit": config.gradient_limit,
        "depth_lsb_mm": config.depth_lsb_px * pixel_pitch_mm,
        "calibration": calibration.name,
        "nodes": [vars(each) for each in records],
        "saturated": clipping,
        "rtl": rtl,
        "faults": faults,
    }
    with written(out, RESULTS) as work:
        np.save(work / "worst.npy", frames)
        save(work / "certificate.json", document)
        for fault in faults:
            print(fault)
    return 1 if faults else 0


main = run
