"""Keywords of run, plan and trade, made by tests/docs/reference_pages.py from what scenes declare."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypedDict, Unpack, overload

import numpy as np

from explorer.commands.plan import RunPlan
from explorer.commands.trade import Trade
from explorer.measure.sampling import Box
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States
from explorer.measure.slices import Slice
from explorer.runs.run import Run
from explorer.scenes.scene import Scene

class OfScene(TypedDict, total=False):
    disk: Disk | str
    seed: int | float | str
    accuracy: float | str
    method: Literal['auto', 'rk4', 'rk8', 'dopri5', 'dop853', 'quadrature']

class OfSampledScene(OfScene, total=False):
    samples: int | float | str
    keep: Literal['none', 'near', 'all']
    chunk_size: int | float | str

class OfFromDensity(OfSampledScene, total=False):
    box: str | Box | Mapping[str, tuple[float, float]]
    energy: str | tuple[float | None, float | None]
    gaussian: str | Box | Mapping[str, tuple[float, float]]
    density: Callable[[Array, Array, Array, Array], Array]

class OfFromStates(OfFromDensity, total=False):
    states: Path | str | States | Any
    degrees: bool

class OfFallingSet(OfFromStates, total=False):
    theta_min: Literal['all', 'near', 'none']
    slice: str | Slice | Sequence[str | Slice]
    grid: int | float | str

class OfMeasureZero(OfFromDensity, total=False):
    ladder: str | tuple[float, float]
    tube: int | float | str
    sampling: Literal['random', 'sobol']

class OfOneSided(TypedDict, total=False):
    disk: Disk | str | Sequence[Disk | str]
    seed: int | float | str
    accuracy: float | str
    method: Literal['auto', 'rk4', 'rk8', 'dopri5', 'dop853', 'quadrature']
    samples: int | float | str
    box: str | Box | Mapping[str, tuple[float, float]]
    eta_hat: str | float | tuple[float, float]

class OfPortrait(OfScene, total=False):
    sigma3_bar: float | str
    sigma4_bar: float | str
    eta_hat: float | str
    energy: str | float | tuple[float, float]
    well: bool

class OfRaceAngles(OfFromStates, total=False):
    eta_hat: str | float | tuple[float, float]
    bounces: int | float | str

class OfSettings(TypedDict, total=False):
    out: Path | str
    exist: Literal['resume', 'replace', 'error']
    jobs: int | float | str
    backend: Literal['threads', 'processes', 'dask']
    scheduler: str
    figures: bool
    format: str | Sequence[str]
    progress: bool
    rng: int | np.random.SeedSequence | np.random.Generator

class FallingSetRun(OfFallingSet, OfSettings, total=False): ...
class MeasureZeroRun(OfMeasureZero, OfSettings, total=False): ...
class OneSidedRun(OfOneSided, OfSettings, total=False): ...
class PortraitRun(OfPortrait, OfSettings, total=False): ...
class RaceAnglesRun(OfRaceAngles, OfSettings, total=False): ...
@overload
def run(scene: Literal["falling-set"], **options: Unpack[FallingSetRun]) -> Run: ...
@overload
def run(scene: Literal["measure-zero"], **options: Unpack[MeasureZeroRun]) -> Run: ...
@overload
def run(scene: Literal["one-sided"], **options: Unpack[OneSidedRun]) -> Run: ...
@overload
def run(scene: Literal["portrait"], **options: Unpack[PortraitRun]) -> Run: ...
@overload
def run(scene: Literal["race-angles"], **options: Unpack[RaceAnglesRun]) -> Run: ...
@overload
def run(scene: str | type[Scene], **options: Any) -> Run: ...

@overload
def plan(scene: Literal["falling-set"], **options: Unpack[FallingSetRun]) -> RunPlan: ...
@overload
def plan(scene: Literal["measure-zero"], **options: Unpack[MeasureZeroRun]) -> RunPlan: ...
@overload
def plan(scene: Literal["one-sided"], **options: Unpack[OneSidedRun]) -> RunPlan: ...
@overload
def plan(scene: Literal["portrait"], **options: Unpack[PortraitRun]) -> RunPlan: ...
@overload
def plan(scene: Literal["race-angles"], **options: Unpack[RaceAnglesRun]) -> RunPlan: ...
@overload
def plan(scene: str | type[Scene], **options: Any) -> RunPlan: ...

def trade(scene: str | type[Scene] | None = ..., *, motions: int = ..., t_end: float | str = ..., progress: bool | None = ..., **options: Any) -> Trade: ...
