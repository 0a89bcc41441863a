"""The same samples by two methods: how long each takes, and how far the answers are apart."""

import os
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer.motion.plan import method_in_words
from explorer.scenes.scene import SampledScene


@dataclass(frozen=True)
class SideBySide:
    """One column of the same samples by an integrator and by the exact layer.

    seconds: on the clock, with compiled kernels, for all about the samples, on `jobs` threads. largest,
    percentile_99: of the differences, relative where `relative`, else in radians. compared: samples that both
    gave.
    """

    column: str
    samples: int
    jobs: int
    method: str
    accuracy: float
    seconds: float
    exact_method: str
    exact_seconds: float
    compared: int
    relative: bool
    largest: float
    percentile_99: float

    def lines(self) -> list[str]:
        """What the comparison says, in words."""
        unit = "" if self.relative else " rad"
        how = "relative difference" if self.relative else "difference"
        return [
            f"{self.samples:,} samples {method_in_words(self.method)} to {self.accuracy:g}: {self.seconds:.2f} s; "
            f"{method_in_words(self.exact_method)}: {self.exact_seconds:.2f} s ({self.jobs} threads)",
            f"largest {how} of {self.column} over {self.compared:,} samples: {self.largest:.1e}{unit}, "
            f"99 % are below {self.percentile_99:.1e}{unit}",
        ]


def exact_of(scene: SampledScene) -> SampledScene:
    """The same question to the exact layer."""
    return replace(scene, method="quadrature", accuracy=min(scene.accuracy, 1e-6))


def side_by_side(scene: SampledScene, column: str, *, relative: bool, jobs: int = 2) -> SideBySide:
    """Compute a scene that integrates, and the same samples by quadrature, and compare one column."""
    exact = exact_of(scene)
    for each in (scene, exact):  # so that no time is that of loading code
        _column(replace(each, samples=1), column, 0)
    seconds, found = _timed(scene, column, jobs)
    exact_seconds, known = _timed(exact, column, jobs)
    both = np.isfinite(found) & np.isfinite(known)
    apart = abs(found[both] - known[both])
    apart = apart / abs(known[both]) if relative else apart
    return SideBySide(
        column,
        scene.samples,
        jobs,
        scene.plan.method,
        scene.accuracy,
        round(seconds, 3),
        exact.plan.method,
        round(exact_seconds, 3),
        int(both.sum()),
        relative,
        float(apart.max(initial=0.0)),
        float(np.quantile(apart, 0.99)) if apart.size else 0.0,
    )


def _timed(scene: SampledScene, column: str, jobs: int) -> tuple[float, NDArray[Any]]:
    """Seconds on the clock, and the column of all samples."""
    from joblib import Parallel, delayed

    began = time.perf_counter()
    jobs = min(jobs, os.cpu_count() or 1)
    parts = Parallel(n_jobs=jobs, backend="threading")(
        delayed(_column)(scene, column, index) for index in range(scene.chunks)
    )
    return time.perf_counter() - began, np.concatenate(parts)


def _column(scene: SampledScene, name: str, index: int) -> NDArray[Any]:
    """What is found of the samples of one chunk."""
    return np.concatenate([scene.observe(block)[name] for block in scene.blocks(index)])
