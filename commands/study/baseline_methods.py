# SPDX-License-Identifier: Apache-2.0
"""Solve in software by several libraries, prepared for a grid and a number of threads."""

from __future__ import annotations

import ctypes
import importlib.metadata
import shutil
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import scipy.fft

from tactile_depth.base import files
from tactile_depth.depth import reference
from tactile_depth.sensor.synthetic import synthetic

Solve = Callable[[Any], Any]


@dataclass(frozen=True)
class Method:
    """Method to solve in software.

    `prepare` takes a size and a number of threads. The method needs the distributions `packages`, the `program` and the
    `device` (CUDA). A method with `one_core` has no threads. A method `from_pixels` begins with the pixels, as the
    pipeline does, all others with their divergence.
    """

    name: str
    prepare: Callable[[int, int], Prepared]
    packages: tuple[str, ...]
    program: str = ""
    device: bool = False
    one_core: bool = False
    from_pixels: bool = False


@dataclass(frozen=True)
class Prepared:
    """Method prepared for one grid.

    `give` converts a float32 array, or the pixels, uint8, to the input of `solve`, `take` its result to an array;
    neither is timed. `synchronise` waits for a device. `clock` times solves in us if the overhead of a call from
    Python would count.
    """

    solve: Solve
    give: Callable[[np.ndarray], Any] = np.asarray
    take: Callable[[Any], np.ndarray] = np.asarray
    synchronise: Callable[[], None] | None = None
    clock: Callable[[Sequence[np.ndarray], int], list[float]] | None = None


def inverse_eigenvalues(size: int) -> np.ndarray:
    values = reference.eigenvalues(size)
    return 1 / (values[:, None] + values)


def with_scipy(size: int, threads: int) -> Prepared:
    factor = inverse_eigenvalues(size).astype(np.float32)

    def solve(f: np.ndarray) -> np.ndarray:
        modes = scipy.fft.dstn(f, type=2, workers=threads)
        modes *= factor
        return scipy.fft.idstn(modes, type=2, workers=threads, overwrite_x=True)

    return Prepared(solve)


def with_ducc0(size: int, threads: int) -> Prepared:
    from ducc0.fft import dst

    factor = (inverse_eigenvalues(size) / (2 * size) ** 2).astype(
        np.float32
    )  # type 3 inverts type 2 except for a factor of 2 N per axis
    modes, depth = np.empty_like(factor), np.empty_like(factor)

    def solve(f: np.ndarray) -> np.ndarray:
        dst(f, type=2, out=modes, nthreads=threads)
        np.multiply(modes, factor, out=modes)
        return dst(modes, type=3, out=depth, nthreads=threads)

    return Prepared(solve)


def with_pyfftw(size: int, threads: int) -> Prepared:
    import pyfftw

    factor = (inverse_eigenvalues(size) / (2 * size) ** 2).astype(np.float32)
    f, modes, depth = (pyfftw.empty_aligned((size, size), np.float32) for _ in range(3))

    def plan(source: np.ndarray, target: np.ndarray, kind: str) -> Any:
        return pyfftw.FFTW(
            source, target, axes=(0, 1), direction=(kind, kind), threads=threads, flags=("FFTW_MEASURE",)
        )

    forward, backward = plan(f, modes, "FFTW_RODFT10"), plan(modes, depth, "FFTW_RODFT01")

    def solve(frame: np.ndarray) -> np.ndarray:
        f[:] = frame
        forward.execute()
        np.multiply(modes, factor, out=modes)
        backward.execute()
        return depth

    return Prepared(solve)


def with_tridiagonal(size: int, threads: int) -> Prepared:
    """Prepare the tridiagonal solver in floats: DST along the rows, Thomas's algorithm down the columns."""
    import numba
    from ducc0.fft import dst

    diagonal = np.tile(reference.eigenvalues(size) - 2, (size, 1))
    diagonal[[0, -1]] -= 1
    table = np.empty((size, size))
    table[0] = 1 / diagonal[0]
    for row in range(1, size):
        table[row] = 1 / (diagonal[row] - table[row - 1])
    coefficients = table.astype(np.float32)
    share = -(-size // threads)
    scale = np.float32(0.5 / size)  # factor of the two transforms along the rows

    @numba.njit(fastmath=True, parallel=threads > 1)  # type: ignore[untyped-decorator]
    def columns(modes: np.ndarray, c: np.ndarray, scale: float) -> None:
        rows = len(modes)
        for part in numba.prange(threads):
            begin, end = part * share, min((part + 1) * share, modes.shape[1])
            for k in range(begin, end):
                modes[0, k] *= scale * c[0, k]
            for i in range(1, rows):
                for k in range(begin, end):
                    modes[i, k] = (scale * modes[i, k] - modes[i - 1, k]) * c[i, k]
            for i in range(rows - 2, -1, -1):
                for k in range(begin, end):
                    modes[i, k] -= c[i, k] * modes[i + 1, k]

    modes, depth = np.empty_like(coefficients), np.empty_like(coefficients)

    def solve(f: np.ndarray) -> np.ndarray:
        dst(f, axes=(1,), type=2, out=modes, nthreads=threads)
        columns(modes, coefficients, scale)
        return dst(modes, axes=(1,), type=3, out=depth, nthreads=threads)

    return Prepared(solve)


SIMD_SOLVER = Path(__file__).with_name("simd_solver.c")
# Not -ffast-math: a library linked with it makes the whole process flush subnormal numbers to zero.
FLOATS = ("-fno-math-errno", "-fno-trapping-math", "-fno-signed-zeros", "-fassociative-math", "-ffp-contract=fast")
COMPILER = ("cc", "-O3", "-march=native", *FLOATS, "-shared", "-fPIC")


def with_c(size: int, threads: int, from_pixels: bool = False) -> Prepared:
    """Prepare the tridiagonal solver in C with SIMD, compiled for this machine and grid.

    Raises RuntimeError: the compiler refuses it.
    """
    with files.temporary() as folder:
        library = folder / "solver.so"
        command = [*COMPILER, f"-DN={size}", str(SIMD_SOLVER), "-o", str(library), "-lm"]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode:
            raise RuntimeError(f"cc cannot compile {SIMD_SOLVER.name}: {result.stderr.splitlines()[0]}")
        solver = ctypes.CDLL(str(library))
    solver.prepare()
    slopes = synthetic().table.astype(np.float32)
    solver.load(ctypes.c_void_p(slopes.ctypes.data))
    depth = np.empty((size, size), np.float32)
    target = ctypes.c_void_p(depth.ctypes.data)
    function = solver.solve_pixels if from_pixels else solver.solve

    def solve(frame: np.ndarray) -> np.ndarray:
        function(ctypes.c_void_p(frame.ctypes.data), target)
        return depth

    def clock(inputs: Sequence[np.ndarray], runs: int) -> list[float]:
        frames = (ctypes.c_void_p * len(inputs))(*(frame.ctypes.data for frame in inputs))
        nanoseconds = np.empty(runs, np.int64)
        solver.time_solves(function, frames, len(inputs), target, runs, ctypes.c_void_p(nanoseconds.ctypes.data))
        return (nanoseconds / 1000).tolist()

    return Prepared(solve, give=np.ascontiguousarray, clock=clock)


def _on(device: str, threads: int) -> tuple[Any, Callable[[np.ndarray], Any], Callable[[Any], np.ndarray], Any]:
    import torch

    if device == "cpu":
        torch.set_num_threads(threads)
    torch.backends.cuda.matmul.allow_tf32 = False
    synchronise = torch.cuda.synchronize if device == "cuda" else None
    return torch, lambda array: torch.tensor(array, device=device), lambda tensor: tensor.cpu().numpy(), synchronise


def with_torch_fft(size: int, threads: int, device: str = "cpu") -> Prepared:
    """Prepare the solve by PyTorch, which has no DST, by Makhoul's method with a real FFT, as in hardware."""
    torch, give, take, synchronise = _on(device, threads)
    half = size // 2
    mode = np.arange(size)
    phase = np.exp(-0.5j * np.pi * mode / size)
    forward_phase = give((2 * phase[: half + 1]).astype(np.complex64))
    factor = give(inverse_eigenvalues(size).astype(np.float32))
    inverse_phase = give((0.5 * np.conj(phase[: half + 1])).astype(np.complex64))
    sign = give(np.where(mode % 2, -1, 1).astype(np.float32))
    order = np.concatenate([mode[::2], mode[1::2][::-1]])  # x0, x2, .., x3, x1
    to_burst, from_burst = give(order), give(np.argsort(order))

    def forward(x: Any) -> Any:
        """Return the DST-II along the last axis, unnormalised like that of scipy."""
        c = torch.fft.rfft((x * sign)[..., to_burst]) * forward_phase
        cosine = torch.cat((c.real, -c.imag[..., 1:half].flip(-1)), -1)  # C[k], then C[N - k]
        return cosine.flip(-1)

    def backward(y: Any) -> Any:
        c = y.flip(-1)
        zero = torch.zeros_like(c[..., :1])
        other = torch.cat((zero, c.flip(-1)), -1)[..., : half + 1]  # C[N - k]
        v = torch.complex(c[..., : half + 1], -other) * inverse_phase
        return torch.fft.irfft(v, n=size)[..., from_burst] * sign

    def solve(f: Any) -> Any:
        modes = forward(forward(f).mT).mT * factor
        return backward(backward(modes).mT).mT

    return Prepared(torch.inference_mode()(solve), give, take, synchronise)


def with_torch_matmul(size: int, threads: int, device: str = "cpu") -> Prepared:
    """Prepare the solve by PyTorch with transforms as products with a dense matrix of sines."""
    torch, give, take, synchronise = _on(device, threads)
    sines = scipy.fft.dst(np.eye(size), type=2, axis=0, norm="ortho")
    right, left = (give(np.ascontiguousarray(m).astype(np.float32)) for m in (sines.T, sines))
    factor = give(inverse_eigenvalues(size).astype(np.float32))

    def solve(f: Any) -> Any:
        return right @ ((left @ f @ right) * factor) @ left

    return Prepared(torch.inference_mode()(solve), give, take, synchronise)


METHODS = (
    Method("scipy, dstn", with_scipy, ("scipy",)),
    Method("ducc0, dst", with_ducc0, ("ducc0",)),
    Method("pyFFTW, RODFT10", with_pyfftw, ("pyFFTW",)),
    Method("PyTorch, rfft", with_torch_fft, ("torch",)),
    Method("PyTorch, products of matrices", with_torch_matmul, ("torch",)),
    Method("ducc0 rows, numba tridiagonal", with_tridiagonal, ("ducc0", "numba")),
    Method("C with SIMD, tridiagonal", with_c, (), program="cc", one_core=True),
    Method(
        "C with SIMD, from the pixels",
        partial(with_c, from_pixels=True),
        (),
        program="cc",
        one_core=True,
        from_pixels=True,
    ),
    Method("PyTorch, rfft, CUDA", partial(with_torch_fft, device="cuda"), ("torch",), device=True),
    Method("PyTorch, products of matrices, CUDA", partial(with_torch_matmul, device="cuda"), ("torch",), device=True),
)


def missing(method: Method) -> str:
    """Return the reason why a method cannot run here, empty if it can."""
    absent = [package for package in method.packages if not any(importlib.metadata.distributions(name=package))]
    if method.program and not shutil.which(method.program):
        absent.append(method.program)
    return f"{', '.join(absent)} not installed" if absent else ""
