"""The price of accuracy on this machine: error and work of every method at every setting.

`nearflat trade` measures it and stores it per machine; a measured table is shipped for machines that
have none. From it `plan` takes the setting of an integrator, and the method where it has a choice.
"""

import json
import os
import platform
import sys
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from explorer import compiled
from explorer.errors import InputError, RunError, shorten
from explorer.phase.arguments import column
from explorer.phase.states import Array

# The measured 99th percentile may take half of the accuracy asked: other bodies, boxes and energies err more than
# those measured, and a motion that may err by more than was asked is followed again.
SAFETY = 2.0
# Errors below the first are those of rounding, which a finer setting does not lower, and so are those within the
# second of the least that any method reaches on the same samples: slow starts among them round more.
_ROUNDING, _NEAR_LEAST = 1e-12, 3.0
_SHOWN = 120  # characters of the path and of the fault in a message
_METHODS = frozenset({"rk4", "rk8", "dopri5", "dop853"})
_FEWEST = 4  # rows above rounding; the method's order is taken from the last three


@dataclass(frozen=True)
class Curve:
    """One method, from coarse to fine: setting (step or tolerance), 99th percentile of the error and
    nanoseconds per passage; and the error below which it is one of rounding."""

    setting: Array
    error: Array
    nanoseconds: Array
    rounding: float

    def at(self, target: Any) -> Array:
        """The setting whose error is `target` over SAFETY.

        Beyond the finest setting whose error is above rounding the method's order is continued, as far as
        settings have been measured; beyond the coarsest it is that one.
        """
        resolved = self.error > self.rounding
        log_setting, log_error = np.log(self.setting[resolved]), np.log(self.error[resolved])
        # A coarser setting that happened to err less must not be preferred to a finer one.
        log_error = np.minimum.accumulate(log_error)
        slope = (log_setting[-1] - log_setting[-3]) / (log_error[-1] - log_error[-3])
        wanted = np.log(np.maximum(target, 1e-300) / SAFETY)
        measured = np.interp(wanted, log_error[::-1], log_setting[::-1])
        continued = measured + slope * np.minimum(wanted - log_error[-1], 0.0)
        settings: Array = np.exp(np.maximum(continued, np.log(self.setting[-1])))
        return settings

    def cost(self, target: float) -> float:
        """Nanoseconds per passage at that setting."""
        here, order = np.log(self.at(target)), np.log(self.setting)[::-1]
        return float(np.exp(np.interp(here, order, np.log(self.nanoseconds)[::-1])))


@dataclass(frozen=True, eq=False)
class Calibration:
    """Curves by method, and where they come from, in words."""

    origin: str
    curves: dict[str, Curve]
    quadrature: float  # nanoseconds per passage
    own: bool = False  # whether it was measured on this machine

    def cheapest(self, methods: tuple[str, ...], target: float) -> str:
        """The method that follows motions in least time to an error of `target`, among those that can."""
        return _cheapest(self, methods, target)


@lru_cache(maxsize=256)
def _cheapest(known: Calibration, methods: tuple[str, ...], target: float) -> str:
    curves = known.curves
    able = [m for m in methods if curves[m].error.min() * SAFETY <= target] or list(methods)
    return min(able, key=lambda method: curves[method].cost(target))


@cache
def current() -> Calibration:
    """This machine's calibration, or the shipped one where none was measured with these kernels."""
    path, advice = stored_at(), "run nearflat trade to measure this machine"
    try:
        if path.exists():
            table = json.loads(path.read_bytes())
            if not isinstance(table, dict) or "kernels" not in table:
                raise ValueError("it does not say by which kernels it was measured")
            if table["kernels"] == compiled.source_digest():
                return replace(parse(table, "measured on this machine"), own=True)
            advice = "this machine's was measured with other kernels; run nearflat trade"
    except (OSError, ValueError) as error:
        reason = shorten(getattr(error, "strerror", None) or str(error), _SHOWN)
        raise InputError(
            f"calibration {shorten(str(path), _SHOWN)} cannot be used ({reason}); delete it, then nearflat trade"
        ) from None
    text = files("explorer.motion").joinpath("calibration.json").read_text(encoding="utf-8")
    return parse(json.loads(text), f"shipped with nearflat; {advice}")


def parse(table: dict[str, Any], origin: str) -> Calibration:
    """A calibration from its JSON form. Raises ValueError for what can be none."""
    curves, quadrature = _curves("methods", table.get("methods")), table.get("quadrature")
    if not isinstance(quadrature, int | float) or not 0.0 < quadrature < np.inf:
        raise ValueError("its quadrature is no time")
    return Calibration(origin, curves, quadrature)


def _curves(name: str, rows_of: Any) -> dict[str, Curve]:
    """The curves of all methods. Raises ValueError for rows that cannot be such."""
    if not isinstance(rows_of, dict):
        raise ValueError(f"its {name} are no rows by method")
    missing = _METHODS - set(rows_of)
    if missing:
        raise ValueError(f"{', '.join(sorted(missing))} missing")
    columns_of = {method: _columns(method, rows_of[method]) for method in sorted(_METHODS)}
    least = min(columns[1].min() for columns in columns_of.values())
    rounding = max(_ROUNDING, _NEAR_LEAST * float(least))
    return {method: _curve(method, columns, rounding) for method, columns in columns_of.items()}


def _columns(method: str, rows: Any) -> Array:
    """The rows of a method as columns. Raises ValueError where they are no such numbers."""
    columns = column(method, rows).T
    if columns.ndim != 2 or columns.shape[0] != 3 or not (np.isfinite(columns) & (columns > 0.0)).all():
        raise ValueError(f"rows of {method} must be three positive numbers each")
    return columns


def _curve(name: str, columns: Array, rounding: float) -> Curve:
    resolved = columns[1][columns[1] > rounding]
    if not ((np.diff(columns[0]) < 0.0).all() and resolved.size >= _FEWEST):
        raise ValueError(f"rows of {name} must go from coarse to fine, {_FEWEST} or more above rounding")
    if not (columns[1][-1] < columns[1][0] and resolved[-1] < resolved[:-2].min()):
        raise ValueError(f"errors of {name} do not fall")
    setting, error, nanoseconds = columns
    return Curve(setting, error, nanoseconds, rounding)


def store(table: dict[str, Any]) -> Path:
    """Keep a measured table for this machine; returns where."""
    path = stored_at()
    temporary = path.with_suffix(f".{os.getpid()}.tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")
        temporary.replace(path)
    except OSError as error:
        raise RunError(
            f"calibration {path} cannot be kept ({error.strerror}); set NEARFLAT_CALIBRATION"
        ) from error
    current.cache_clear()
    return path


def stored_at() -> Path:
    """The file of this machine's calibration; NEARFLAT_CALIBRATION names another one."""
    chosen = os.environ.get("NEARFLAT_CALIBRATION")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Application Support"
    else:
        base = Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share")
    name = "".join(c if c.isalnum() else "-" for c in platform.node()) or "machine"
    return base / "nearflat" / f"calibration-{name}.json"
