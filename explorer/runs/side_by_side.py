"""The same samples by two methods: how long each takes, and how far the answers are apart."""

import os
import time
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer.motion.compare import ANGLES, apart
from explorer.motion.plan import method_in_words
from explorer.scenes.scene import SampledScene


def exact_of(scene: SampledScene) -> SampledScene:
    """The same question to the exact layer."""
    return replace(scene, method="quadrature", accuracy=min(scene.accuracy, 1e-6))


def side_by_side(scene: SampledScene, column: str, *, jobs: int = 2) -> dict[str, Any]:
    """Compute a scene that integrates, and the same samples by quadrature, and compare one column.

    seconds: on the clock, with compiled kernels, for all about the samples, on `jobs` threads. largest,
    percentile_99: of the differences, as `apart` has them. compared: samples that both
    gave.
    """
    exact = exact_of(scene)
    for each in (scene, exact):  # so that no time is that of loading code
        _column(replace(each, samples=1), column, 0)
    (seconds, found), (exact_seconds, known) = (_timed(each, column, jobs) for each in (scene, exact))
    both = np.isfinite(found) & np.isfinite(known)
    away = apart(column, found[both], known[both])
    return {
        "column": column,
        "samples": scene.samples,
        "jobs": jobs,
        "method": scene.plan.method,
        "accuracy": scene.accuracy,
        "seconds": round(seconds, 3),
        "exact_method": exact.plan.method,
        "exact_seconds": round(exact_seconds, 3),
        "compared": int(both.sum()),
        "relative": column not in ANGLES,
        "largest": float(away.max(initial=0.0)),
        "percentile_99": float(np.quantile(away, 0.99)) if away.size else 0.0,
    }


def in_words(found: dict[str, Any]) -> list[str]:
    """What a comparison says."""
    how, unit = ("relative difference", "") if found["relative"] else ("difference", " rad")
    method, exact = method_in_words(found["method"]), method_in_words(found["exact_method"])
    return [
        f"{found['samples']:,} samples {method} to {found['accuracy']:g}: {found['seconds']:.2f} s; "
        f"{exact}: {found['exact_seconds']:.2f} s ({found['jobs']} threads)",
        f"largest {how} of {found['column']} over {found['compared']:,} samples: {found['largest']:.1e}{unit}, "
        f"99 % are below {found['percentile_99']:.1e}{unit}",
    ]


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
