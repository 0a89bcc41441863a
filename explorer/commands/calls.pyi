"""Keywords of run, plan and trade, made by tests/tools/reference_pages.py from what scenes declare."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypedDict, Unpack, overload

import numpy as np

from explorer.commands.plan import RunPlan
from explorer.motion.work_precision import Trade
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States
from explorer.measure.slices import Slice
from explorer.runs.run import Run
from explorer.scenes.scene import Scene

class Keywords(TypedDict, total=False):
    disk: Disk | str | Sequence[Disk | str]
    seed: int | float | str | np.random.SeedSequence | np.random.Generator
    rng: int | float | str | np.random.SeedSequence | np.random.Generator
    accuracy: float | str
    method: Literal['auto', 'rk4', 'rk8', 'dopri5', 'dop853', 'quadrature']
    samples: int | float | str
    keep: Literal['none', 'near', 'all']
    chunk_size: int | float | str
    box: str | Mapping[str, Any]
    energy: str | tuple[float | None, float | None]
    density: Callable[..., Array]
    degrees: bool
    states: Path | str | States | Any
    theta_min: Literal['all', 'near', 'none']
    slice: str | Slice | Sequence[str | Slice]
    grid: int | float | str
    ladder: str | tuple[float, float]
    tube: int | float | str
    eta_hat: str | float | tuple[float, float]
    start: Literal['near', 'anywhere']
    bounces: int | float | str
    jobs: int | float | str
    backend: Literal['threads', 'processes', 'dask']
    scheduler: str
    overfill: bool
    figures: bool
    format: str | Sequence[str]
    out: Path | str
    exist: Literal['resume', 'replace', 'error']
    progress: bool

Known = Literal['falling-set', 'measure-zero', 'one-sided', 'race-angles']

@overload
def run(scene: Known, **options: Unpack[Keywords]) -> Run: ...
@overload
def run(scene: str | type[Scene], **options: Any) -> Run: ...

@overload
def plan(scene: Known, **options: Unpack[Keywords]) -> RunPlan: ...
@overload
def plan(scene: str | type[Scene], **options: Any) -> RunPlan: ...

def trade(*, disk: Disk | str = ..., samples: int | float | str = ..., seed: int | float | str | np.random.SeedSequence | np.random.Generator = ..., rng: int | float | str | np.random.SeedSequence | np.random.Generator = ..., box: str | Mapping[str, Any] = ..., eta_hat: str | float | tuple[float, float] = ..., progress: bool = ...) -> Trade: ...
