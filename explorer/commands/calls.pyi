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
from explorer.portrait.slices import Slice
from explorer.runs.run import Run
from explorer.scenes.scene import Scene

class FallingSet(TypedDict, total=False):
    disk: Disk | str
    seed: int | float | str
    accuracy: float | str
    method: Literal['auto', 'rk4', 'rk8', 'dopri5', 'dop853', 'quadrature']
    samples: int | float | str
    keep: Literal['none', 'near', 'all']
    chunk_size: int | float | str
    box: str | Box | Mapping[str, tuple[float, float]]
    energy: str | tuple[float | None, float | None]
    gaussian: str | Box | Mapping[str, tuple[float, float]]
    density: Callable[[Array, Array, Array, Array], Array]
    states: Path | str | States | Any
    degrees: bool
    theta_min: Literal['all', 'near', 'none']
    slice: str | Slice | Sequence[str | Slice]
    grid: int | float | str

class MeasureZero(TypedDict, total=False):
    disk: Disk | str
    seed: int | float | str
    accuracy: float | str
    method: Literal['auto', 'rk4', 'rk8', 'dopri5', 'dop853', 'quadrature']
    samples: int | float | str
    keep: Literal['none', 'near', 'all']
    chunk_size: int | float | str
    box: str | Box | Mapping[str, tuple[float, float]]
    energy: str | tuple[float | None, float | None]
    gaussian: str | Box | Mapping[str, tuple[float, float]]
    density: Callable[[Array, Array, Array, Array], Array]
    ladder: str | tuple[float, float]
    tube: int | float | str
    sampling: Literal['random', 'sobol']

class OneSided(TypedDict, total=False):
    disk: Disk | str | Sequence[Disk | str]
    seed: int | float | str
    accuracy: float | str
    method: Literal['auto', 'rk4', 'rk8', 'dopri5', 'dop853', 'quadrature']
    samples: int | float | str
    box: str | Box | Mapping[str, tuple[float, float]]
    eta_hat: str | float | tuple[float, float]

class Portrait(TypedDict, total=False):
    disk: Disk | str
    seed: int | float | str
    accuracy: float | str
    method: Literal['auto', 'rk4', 'rk8', 'dopri5', 'dop853', 'quadrature']
    sigma3_bar: float | str
    sigma4_bar: float | str
    eta_hat: float | str
    energy: str | float | tuple[float, float]
    well: bool

class RaceAngles(TypedDict, total=False):
    disk: Disk | str
    seed: int | float | str
    accuracy: float | str
    method: Literal['auto', 'rk4', 'rk8', 'dopri5', 'dop853', 'quadrature']
    samples: int | float | str
    keep: Literal['none', 'near', 'all']
    chunk_size: int | float | str
    box: str | Box | Mapping[str, tuple[float, float]]
    energy: str | tuple[float | None, float | None]
    gaussian: str | Box | Mapping[str, tuple[float, float]]
    density: Callable[[Array, Array, Array, Array], Array]
    states: Path | str | States | Any
    degrees: bool
    eta_hat: str | float | tuple[float, float]
    bounces: int | float | str

class OfRun(TypedDict, total=False):
    out: Path | str
    exist: Literal['resume', 'replace', 'error']
    jobs: int | float | str
    backend: Literal['threads', 'processes', 'dask']
    scheduler: str
    memory: str | float
    figures: bool
    format: str | Sequence[str]
    progress: bool
    rng: int | np.random.SeedSequence | np.random.Generator

class OfTrade(TypedDict, total=False):
    motions: int
    t_end: float | str
    progress: bool | None

class FallingSetRun(FallingSet, OfRun, total=False): ...
class FallingSetTrade(FallingSet, OfTrade, total=False): ...

class MeasureZeroRun(MeasureZero, OfRun, total=False): ...
class MeasureZeroTrade(MeasureZero, OfTrade, total=False): ...

class OneSidedRun(OneSided, OfRun, total=False): ...
class OneSidedTrade(OneSided, OfTrade, total=False): ...

class PortraitRun(Portrait, OfRun, total=False): ...
class PortraitTrade(Portrait, OfTrade, total=False): ...

class RaceAnglesRun(RaceAngles, OfRun, total=False): ...
class RaceAnglesTrade(RaceAngles, OfTrade, total=False): ...

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

@overload
def trade(scene: Literal["falling-set"], **options: Unpack[FallingSetTrade]) -> Trade: ...
@overload
def trade(scene: Literal["measure-zero"], **options: Unpack[MeasureZeroTrade]) -> Trade: ...
@overload
def trade(scene: Literal["one-sided"], **options: Unpack[OneSidedTrade]) -> Trade: ...
@overload
def trade(scene: Literal["portrait"], **options: Unpack[PortraitTrade]) -> Trade: ...
@overload
def trade(scene: Literal["race-angles"] | None = ..., **options: Unpack[RaceAnglesTrade]) -> Trade: ...
@overload
def trade(scene: str | type[Scene], **options: Any) -> Trade: ...
