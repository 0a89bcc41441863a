"""The price of accuracy on this machine: error and work of every method at every setting.

`nearflat trade` measures it and stores it per machine; a measured table is shipped for machines that
have none. From it `plan` takes the setting of an integrator, and the method where it has a choice.
"""

import json
import os
import platform
import sys
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from explorer import compiled
from explorer.errors import InputError, RunError
from explorer.phase.states import Array

# The measured 99th percentile may take half of the accuracy asked: other bodies, boxes and energies err more than
# those measured, and a motion that may err by more than was asked is followed again.
SAFETY = 2.0
# Steps in units of 1/speed and tolerances at which methods are measured, from coarse to fine.
SETTINGS: dict[str, tuple[float, ...]] = {
    "rk4": (0.25, 0.05, 0.02, 0.002),
    "rk8": (1.6, 1.2, 0.8, 0.5, 0.16, 0.08),
    "dopri5": tuple(10.0 ** -np.arange(3.5, 11.6)),
    "dop853": tuple(10.0 ** -np.arange(2.0, 13.1)),
}


@dataclass(frozen=True)
class Curve:
    """One method, from coarse to fine: setting (step or tolerance), 99th percentile of the error and
    nanoseconds per passage."""

    setting: Array
    error: Array
    nanoseconds: Array

    def at(self, target: Any) -> Array:
        """The setting whose error is `target` over SAFETY; beyond both ends of the curve that at the end."""
        return self._at(target, self.setting)

    def cost(self, target: float) -> float:
        """Nanoseconds per passage at that setting."""
        return float(self._at(target, self.nanoseconds))

    def _at(self, target: Any, column: Array) -> Array:
        wanted = np.log(np.asarray(target) / SAFETY)
        return np.asarray(np.exp(np.interp(wanted, np.log(self.error[::-1]), np.log(column[::-1]))))


@dataclass(frozen=True)
class Calibration:
    """Curves by method, and where they come from, in words."""

    origin: str
    curves: dict[str, Curve]
    quadrature: float  # nanoseconds per passage
    own: bool = False  # whether it was measured on this machine

    def cheapest(self, methods: tuple[str, ...], target: float) -> str:
        """The method that follows motions in least time to an error of `target`, among those that can."""
        able = [method for method in methods if SAFETY * self.curves[method].error[-1] <= target]
        return min(able or methods, key=lambda method: self.curves[method].cost(target))


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
                return parse(table, "measured on this machine", own=True)
            advice = "this machine's was measured with other kernels; run nearflat trade"
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"calibration {path} cannot be used ({reason}); delete it, then nearflat trade") from None
    return parse(_shipped(), f"shipped with nearflat; {advice}")


def _shipped() -> dict[str, Any]:
    table: dict[str, Any] = json.loads(files("explorer.motion").joinpath("calibration.json").read_bytes())
    return table


def shipped_errors() -> dict[tuple[str, float], float]:
    """The errors that come with nearflat, by method and setting: the largest of several bodies."""
    curves = parse(_shipped(), "").curves
    return {
        (method, setting): error
        for method, curve in curves.items()
        for setting, error in zip(curve.setting.tolist(), curve.error.tolist(), strict=True)
    }


def parse(table: dict[str, Any], origin: str, own: bool = False) -> Calibration:
    """A calibration from its JSON form: its settings, else SETTINGS, and what was measured at each of them.

    That is error and nanoseconds, or null where a setting gains nothing. Raises ValueError for what can be none.
    """
    try:
        methods, settings = table["methods"], table.get("settings", SETTINGS)
        columns = {
            method: np.array(
                [(setting, *row) for setting, row in zip(settings[method], methods[method], strict=True) if row],
                np.float64,
            ).T
            for method in SETTINGS
        }
        curves = {method: Curve(*numbers) for method, numbers in columns.items()}
        quadrature = float(table["quadrature"])
    except (AttributeError, KeyError, TypeError, ValueError):
        raise ValueError("it lacks settings, methods or quadrature, or has others than numbers there") from None
    for method, numbers in columns.items():
        falls = numbers.shape[1] > 1 and (np.diff(numbers[:2]) < 0.0).all()
        if not (falls and ((numbers > 0.0) & (numbers < np.inf)).all() and 0.0 < quadrature < np.inf):
            raise ValueError(f"settings and errors of {method} do not fall, or numbers are not finite and above 0")
    return Calibration(origin, curves, quadrature, own)


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
