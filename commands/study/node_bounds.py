# SPDX-License-Identifier: Apache-2.0
"""The overflow certificate: the largest value that each node of a solver can be asked to hold, and the worst input.

Except for rounding, every step from slope to depth is linear. So the largest value of a node over a box of inputs is
the L1 norm of its response, and the input that attains it has the signs of that response. The responses are computed
by the bit-accurate models, run on floats with their own coefficients and shifts, one direction at a time. The response
of a node is the outer product of a row response and a column response. In the inverse row transform it is a sum of
such products over all row modes.

There are two boxes. Slopes: every |gx|, |gy| is at most the gradient limit. Depths: every |z| is at most the depth
range. An input within the formats lies in both boxes, so a word never exceeds the smaller of its two norms.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from commands.common.slopes import places, steps
from tactile_depth.chip.bounds import Responses, l1
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import Format
from tactile_depth.chip.poisson import spectral_solver, tridiagonal_solver
from tactile_depth.chip.poisson.elimination import coefficient_rows, elimination
from tactile_depth.chip.poisson.frame_stack import frame_stack
from tactile_depth.chip.poisson.spectral_divide import reciprocals
from tactile_depth.chip.poisson.substitution import substitution
from tactile_depth.chip.poisson.thomas_table import ahead_rows
from tactile_depth.chip.poisson.transform.orders import makhoul

BLOCK_BYTES = 1 << 26  # bytes of responses held at a time
TRIED = 1 << 32  # most products computed for a node of the inverse row transform, whose words are tried one by one


@dataclass(frozen=True)
class Node:
    """A node and the largest value that it can be asked to hold, in units of its own word (value = code * lsb).

    Attributes
    ----------
    name : str
        Name that the models report to a Monitor.
    form : Format
    slopes : float
        Upper bound of the value over all slopes within the gradient limit.
    reached : float
        Value for the slopes that have the signs of `response`. It equals `slopes`, except at nodes of the inverse row
        transform, where not every word is tried.
    depths : float
        Upper bound of the value over all inputs whose depth stays in the depth range.
    response : float64 array (rows, columns)
        Response of the word of `reached` to the divergence, codes per code, in the order of the frame.
    """

    name: str
    form: Format
    slopes: float
    reached: float
    depths: float
    response: np.ndarray = field(repr=False, compare=False)

    @property
    def largest(self) -> float:
        """Largest value of the format."""
        return self.form.limit - self.form.lsb

    @property
    def slopes_headroom_bits(self) -> float:
        """Bits between the largest value over the slopes and full scale; negative if some input saturates the node."""
        return _headroom(self.largest, self.slopes)

    @property
    def depths_headroom_bits(self) -> float:
        """Bits between the largest value over the depths and full scale.

        It is negative if an input within the depth range saturates the node.
        """
        return _headroom(self.largest, self.depths)


def _headroom(largest: float, worst: float) -> float:
    return math.log2(largest / worst) if worst else math.inf


def node_format(name: str, config: Configuration) -> Format:
    """Return the format of a node's word, by the name of the node."""
    core, _, rest = name.partition(".")
    width = config.arithmetic_width
    if core == "row_inverse":
        if rest.startswith("pair"):
            return config.elimination
        return config.depth if rest == "output" else config.row_inverse
    if config.solver == "spectral":
        if core == "row_forward":
            return config.row_modes if rest == "phase.re" else config.row_forward
        if core == "column_inverse":
            return config.depth_modes if rest == "output" else config.column_inverse
        return config.column_inverse if core == "spectral_divide" else config.column_forward
    if core == "row_forward" and rest != "phase.re":
        return config.row_forward
    if rest in ("store", "ahead"):
        return config.elimination_store
    drop = config.moment_drop if rest == "moment" else 0
    return Format(width, config.elimination.fraction - drop)


def _variation(response: np.ndarray, neumann: bool) -> np.ndarray:
    return l1(steps(response, neumann))


def _second_difference(response: np.ndarray, neumann: bool) -> np.ndarray:
    """Return the second difference along axis 0 with the boundary of the solver; this operator is symmetric."""
    ghost = 1 if neumann else -1
    return np.diff(np.concatenate((ghost * response[:1], response, ghost * response[-1:])), n=2, axis=0)


@dataclass
class _Worst:
    """Worst words of a node.

    `slopes` is the largest norm over slopes, `reached` and `response` belong to the same word. `depths` is the largest
    value, over all words, of the smaller of the two norms.
    """

    slopes: float = -1.0
    depths: float = 0.0
    reached: float = -1.0
    response: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def see(self, slopes: np.ndarray, depths: np.ndarray, response: Callable[[int], np.ndarray]) -> None:
        """Take the norms of words over both boxes; `response(index)` returns the response of a word."""
        self.depths = max(self.depths, float(np.minimum(slopes, depths).max()))
        best = int(np.argmax(slopes))
        if slopes[best] > self.slopes:
            self.slopes = self.reached = float(slopes[best])
            self.response = response(best)


class _Survey:
    """Worst words of all nodes of a configuration; slopes and depths are scaled so that norms are in codes."""

    def __init__(self, config: Configuration, progress: Callable[[float], None]) -> None:
        self.config = config
        self.neumann = config.neumann
        self.progress = progress
        self.worst: defaultdict[str, _Worst] = defaultdict(_Worst)
        self.slope = config.gradient_limit / config.gradient_lsb  # largest slope and depths, in codes
        self.depth_in = config.deepest_px / config.gradient_lsb  # depth field whose Laplacian enters
        self.depth_out = config.deepest_px / config.depth_lsb_px
        self.in_pairs = config.solver == "tridiagonal"
        stages = spectral_solver if config.solver == "spectral" else tridiagonal_solver
        forward, inverse = Responses(), Responses()
        unit = np.eye(config.columns)
        self.modes = stages.row_forward(unit, config, forward)  # (column, mode's position)
        # (mode's position, column); a row alone in its pair
        lone = unit[:, None] if self.in_pairs else unit
        self.to_row = stages.row_inverse(lone, config, inverse).reshape(unit.shape)
        self.forward, self.inverse = forward.nodes, inverse.nodes
        self.from_row = np.linalg.inv(self.to_row)  # (column, mode's position): modes of a row of depth codes
        self.mode_l1, self.mode_variation = l1(self.modes), _variation(self.modes, self.neumann)
        self.mode_depth = l1(self.from_row) * self.depth_out  # largest words at the input of the inverse row transform

    def outer(self, column: np.ndarray, mode: int) -> np.ndarray:
        return np.outer(column, self.modes[:, mode])

    # Row transform of a single row. Its gy counts twice, because it is subtracted again in the row below.

    def row_forward(self) -> None:
        middle = np.arange(self.config.rows) == self.config.rows // 2
        for name, response in self.forward.items():
            length = l1(response)
            slopes = _variation(response, self.neumann) + 2 * length
            along = _second_difference(response, self.neumann)
            inside = 2 * length + l1(along - 2 * response)
            edge = length + l1(along - (1 if self.neumann else 3) * response)
            depths = np.maximum(inside, edge)

            def alone(word: int, response: np.ndarray = response) -> np.ndarray:
                return np.outer(middle, response[:, word])

            self.worst[name].see(slopes * self.slope, depths * self.depth_in, alone)

    def column_norm(self, response: np.ndarray, mode: int | slice | np.ndarray) -> np.ndarray:
        """Return the norms over slopes of words, from their responses to the column of a row mode: (rows, words)."""
        norm: np.ndarray = (
            self.mode_l1[mode] * _variation(response, self.neumann) + self.mode_variation[mode] * l1(response)
        ) * self.slope
        return norm

    # Inverse row transform. `sources` maps some rows of depth to the response (modes, rows) of the modes of that row.

    def groups(self) -> list[tuple[int, ...]]:
        """Return the rows of `places`, or the pairs of rows that they are in: the row that leaves first, the next."""
        rows = places(self.config.rows)
        if not self.in_pairs:
            return [(row,) for row in rows]
        last = self.config.rows - 1
        # Row 1 is in the last whole pair, also where row 0 is alone.
        firsts = sorted({last - (last - row) // 2 * 2 for row in (*rows, 1, self.config.rows // 2 + 1)})
        return [(first, first - 1) if first else (first,) for first in firsts]

    def partner(self, name: str) -> np.ndarray:
        """Return the words of a node (mode's position, words) for the second row of a pair: its modes come times j."""
        other = name[:-3] + {".re": ".im", ".im": ".re"}.get(name[-3:], "")
        if other not in self.inverse:
            return np.zeros_like(self.inverse[name])
        return -self.inverse[other] if name.endswith(".re") else self.inverse[other]

    def row_inverse(self, sources: dict[int, np.ndarray]) -> None:
        size = self.config.columns
        output = list(self.inverse)[-1]

        def response(row: int, word: np.ndarray) -> np.ndarray:
            return (sources[row] * word[:, None]).T @ self.modes.T

        def of_group(group: tuple[int, ...], words: tuple[np.ndarray, ...]) -> np.ndarray:
            return np.sum([response(row, word) for row, word in zip(group, words, strict=False)], axis=0)

        def norm(seen: np.ndarray) -> float:
            return float(sum(np.abs(steps(seen, self.neumann, axis)).sum() for axis in (0, 1))) * self.slope

        deepest = {}  # norm of each position of a row
        for row in sources:
            deepest[row] = np.array([norm(response(row, self.to_row[:, column])) for column in range(size)])
            self.progress(1 / len(sources) / 2)
        modes = {row: self.column_norm(source.T, slice(None)) for row, source in sources.items()}
        most = max(1, TRIED // (self.config.rows * size * size))
        for name, words in self.inverse.items():
            worst = self.worst[name]
            if name == output:
                worst.depths = float((l1(self.from_row @ words) * self.depth_out).max())
                row = max(sources, key=lambda row: float(deepest[row].max()))
                column = int(np.argmax(deepest[row]))
                worst.slopes = worst.reached = float(deepest[row][column])
                worst.response = response(row, self.to_row[:, column])
                continue
            # A word is a sum over the depths of its rows, and a sum over the modes of its rows. Both give an upper
            # bound. The words with the largest bounds are tried first, until no other bound exceeds the value reached.
            parts = (words, self.partner(name)) if self.in_pairs else (words,)
            by_depth, by_mode = [np.abs(self.from_row @ part) for part in parts], [np.abs(part) for part in parts]
            groups = self.groups()
            atmost = np.stack(
                [
                    np.sum(
                        [
                            np.minimum(deepest[row] @ depth, modes[row] @ mode)
                            for row, depth, mode in zip(group, by_depth, by_mode, strict=False)
                        ],
                        axis=0,
                    )
                    for group in groups
                ]
            )
            depths = np.sum([l1(part) for part in by_depth], axis=0) * self.depth_out
            worst.depths = float(np.minimum(atmost.max(axis=0), depths).max())
            order = np.argsort(atmost, axis=None)[::-1]
            worst.reached, worst.response = 0.0, np.zeros((self.config.rows, size))
            for tries, index in enumerate(order):
                place, column = np.unravel_index(index, atmost.shape)
                worst.slopes = max(worst.reached, float(atmost[place, column]))
                if worst.reached >= atmost[place, column] or tries == most:
                    break
                seen = of_group(groups[place], tuple(part[:, column] for part in parts))
                reached = norm(seen)
                if reached > worst.reached or not tries:
                    worst.reached, worst.response = reached, seen
            self.progress(1 / len(self.inverse) / 2)


class _Spectral(_Survey):
    def columns(self) -> dict[int, np.ndarray]:
        config, neumann = self.config, self.neumann
        size = config.columns
        order = makhoul(size)
        forward = Responses()
        modes = spectral_solver.column_forward(np.eye(size)[:, order], config, forward)  # (row, mode's position)
        mode_second = l1(_second_difference(self.modes, neumann))
        for name, response in forward.nodes.items():
            slopes = self.column_norm(response[:, :, None], slice(None))
            second = l1(_second_difference(response, neumann))
            depths = np.outer(second, self.mode_l1) + np.outer(l1(response), mode_second)

            def of_column(index: int, response: np.ndarray = response) -> np.ndarray:
                word, mode = divmod(index, size)
                return self.outer(response[:, word], mode)

            self.worst[name].see(slopes.ravel(), depths.ravel() * self.depth_in, of_column)

        inverse = Responses()
        # (mode's position, row in Makhoul order)
        to_column = spectral_solver.column_inverse(np.eye(size), config, inverse)
        from_column = np.linalg.inv(to_column)
        # From a column of stored words back to each node, then from the depth to that column.
        lengths = {name: l1(from_column @ words) for name, words in inverse.nodes.items()}
        lengths = {"spectral_divide": l1(from_column), **lengths}
        table = reciprocals(config)
        factor = table.mantissa * 2.0 ** (table.shift - table.drop)
        rows = places(size)
        position = np.argsort(order)  # position of each row in Makhoul order
        sources = {row: np.empty((size, size)) for row in rows}
        for mode in range(size):
            nodes = Responses()
            divided = modes * factor[mode]
            column = spectral_solver.column_inverse(divided, config, nodes)
            for name, response in {"spectral_divide": divided, **nodes.nodes}.items():

                def of_mode(word: int, response: np.ndarray = response, mode: int = mode) -> np.ndarray:
                    return self.outer(response[:, word], mode)

                self.worst[name].see(self.column_norm(response, mode), lengths[name] * self.mode_depth[mode], of_mode)
            for row in rows:
                sources[row][mode] = column[:, position[row]]
            self.progress(1 / size)
        return sources


class _Tridiagonal(_Survey):
    def columns(self) -> dict[int, np.ndarray]:
        rows, size = self.config.rows, self.config.columns
        block = max(1, BLOCK_BYTES // (8 * rows * size))
        starts = range(0, rows, block)
        norms: dict[tuple[str, int], np.ndarray] = {}
        for first in starts:

            def add(node: str, row: int, response: np.ndarray, first: int = first) -> None:
                # The sample after the block, if there is one, takes part in the differences only.
                last = first + block >= rows
                own = response[:block]
                change = np.diff(response, axis=0, append=0) if last else np.diff(response, axis=0)
                if last and self.neumann:
                    change[-1] = 0
                modes = slice(own.shape[1])
                norm = self.mode_l1[modes] * l1(change) + self.mode_variation[modes] * l1(own)
                norms[node, row] = norms.get((node, row), 0.0) + norm * self.slope

            self.run(first, min(first + block + 1, rows), add)
            self.progress(1 / len(starts) / 2)

        wanted: dict[str, tuple[int, int]] = {}
        columns = {node: np.zeros(rows) for node, _ in norms}
        for (node, row), slopes in norms.items():

            def later(mode: int, node: str = node, row: int = row) -> np.ndarray:
                wanted[node] = row, mode
                return columns[node]

            self.worst[node].see(slopes, self.in_depths(node, row), later)

        sources = {row: np.empty((size, rows)) for group in self.groups() for row in group}
        for first in starts:

            def collect(node: str, row: int, response: np.ndarray, first: int = first) -> None:
                at, mode = wanted[node]
                samples = slice(first, first + len(response))
                if at == row:
                    columns[node][samples] = response[:, mode]
                if node == "substitution" and row in sources:
                    sources[row][:, samples] = response.T

            self.run(first, min(first + block, rows), collect)
            self.progress(1 / len(starts) / 2)
        for node, (_, mode) in wanted.items():
            self.worst[node].response = self.outer(columns[node], mode)
        return sources

    def run(self, first: int, stop: int, hear: Callable[[str, int, np.ndarray], None]) -> None:
        """Run both passes of Thomas's algorithm on unit words in the rows `first` to `stop`, in every mode.

        `hear` is called with node, row and response (samples, modes), for all modes or for position 0 only.
        """
        rows, size = self.config.rows, self.config.columns
        calls: dict[str, int] = {}

        class Told(Monitor):
            def linear(self, node: str, response: np.ndarray) -> None:
                if response.ndim == 3:
                    for row in range(response.shape[1]):
                        hear(node, row, response[:, row])
                    return
                if node.endswith(".store"):  # d of the last row
                    hear(node, rows - 1, response)
                    return
                call = calls[node] = calls.get(node, -1) + 1
                row = rows - 1 - call if node == "substitution" else call
                hear(node, row, response if response.ndim == 2 else response[:, None])

        lone = np.zeros((stop - first, rows, size))
        lone[np.arange(stop - first), np.arange(first, stop)] = 1
        substitution(frame_stack(elimination(lone, self.config, Told())), self.config, Told())

    def in_depths(self, node: str, row: int) -> np.ndarray:
        """Return the largest words over all depths: d[i] is z[i] + c[i] z[i+1], and c[i] multiplies d[i] / c[i].

        With a look ahead, e[i] is z[i] - p[i] z[i+2], where p[i] is c[i] c[i+1] as the table up the rows has it. Since
        d[i] is e[i] + c[i] d[i+1], the rounding of p in the rows below adds to it.
        """
        config = self.config
        part = node.partition(".")[2]
        z = self.mode_depth
        if part == "moment":  # of a column without mean: rows times its last word
            return z[:1] * config.rows / 2**config.moment_drop
        if part == "mean":
            return z[:1]
        if not part:
            return z
        c, product, rounding = (values[row] for values in self.coefficients)
        below = row < config.rows - 1
        with np.errstate(divide="ignore"):
            if part == "difference":
                return z * ((1 + rounding) / np.abs(c) + below)
        drop = config.elimination.fraction - config.elimination_store.fraction if part in ("store", "ahead") else 0
        if part == "ahead":
            return z * (1 + np.abs(product)) / 2**drop
        return z * (1 + np.abs(c) * below + rounding) / 2**drop

    @cached_property
    def coefficients(self) -> tuple[np.ndarray, ...]:
        """Each row's c, p, and the norm of what the rounding of p in it and below adds to d."""
        one = 2.0**self.config.coefficient.fraction
        c = coefficient_rows(self.config, self.config.rows) / one
        product = np.zeros_like(c)
        product[:-2] = -ahead_rows(self.config) / one
        rounding = np.zeros_like(c)
        for row in range(self.config.rows - 3, -1, -1):
            rounding[row] = np.abs(c[row] * c[row + 1] - product[row]) + np.abs(c[row]) * rounding[row + 1]
        return c, product, rounding


def node_bounds(config: Configuration, progress: Callable[[float], None] = lambda share: None) -> list[Node]:
    """Return every node of the configuration's solver in the order of the stream, with its largest values.

    Parameters
    ----------
    progress : callable
        Called with the work done since the last call, as a fraction of all work.
    """
    survey = (_Spectral if config.solver == "spectral" else _Tridiagonal)(config, lambda share: progress(share / 2))
    survey.row_forward()
    survey.row_inverse(survey.columns())
    nodes = []
    for name, worst in survey.worst.items():
        form = node_format(name, config)
        slopes, reached, depths = (norm * form.lsb for norm in (worst.slopes, worst.reached, worst.depths))
        nodes.append(Node(name, form, slopes, reached, depths, worst.response))
    return nodes
