"""The same samples by two methods: how long each takes, and how far the answers are apart."""

import time
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer.motion.compare import ANGLES, apart
from explorer.motion.plan import method_in_words
from explorer.runs.run import execute
from explorer.runs.settings import Settings
from explorer.scenes.scene import SampledScene


def exact_of(scene: SampledScene) -> SampledScene:
    """The same question to the exact layer."""
    return replace(scene, method="quadrature", accuracy=min(scene.accuracy, 1e-6))


def side_by_side(scene: SampledScene, column: str, *, jobs: int = 2) -> dict[str, Any]:
    """Run a scene that integrates, and the same samples by quadrature, and compare one column.

    seconds: on the clock, for the whole run in memory, with compiled kernels. largest, percentile_99: of the
    differences, as `apart` has them. compared: samples that both gave.
    """
    exact = exact_of(scene)
    for each in (scene, exact):  # so that no time is that of loading code
        _timed(replace(each, samples=min(each.samples, 100)), column, 1)
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
    began = time.perf_counter()
    run = execute(replace(scene, keep="all"), Settings.of({"jobs": jobs, "progress": False}))
    return time.perf_counter() - began, np.concatenate([table[column] for table in run.tables([column])])
