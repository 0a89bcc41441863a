"""nearflat: a Monte Carlo explorer of the rolling disk's phase space.

    import explorer as ex
    disk = ex.Disk.uniform()
    states = ex.phi_to_states(disk, phi=0.0, phidot=1.0, sigma3=1.0, sigma4=0.7)
    ex.constants(states)
    ex.run("race-angles", disk=disk, samples=100_000)

Names are loaded on first use, so that importing this package is cheap.
"""

import sys
from collections.abc import Callable
from importlib import import_module
from operator import attrgetter
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from explorer import plot as plot
    from explorer import portrait as portrait
    from explorer.commands.cite import cite as cite
    from explorer.commands.plan import plan as plan
    from explorer.commands.run import run as run
    from explorer.commands.trade import trade as trade
    from explorer.compiled import status as _status
    from explorer.errors import CoarseTimesWarning as CoarseTimesWarning
    from explorer.errors import InputError as InputError
    from explorer.errors import Interrupted as Interrupted
    from explorer.errors import RunError as RunError
    from explorer.measure.falling_constant import falling_constant as falling_constant
    from explorer.measure.invariance import flow_stretch as flow_stretch
    from explorer.measure.invariance import push_forward as push_forward
    from explorer.motion.bounces import bounces as bounces
    from explorer.motion.forces import passage_forces as passage_forces
    from explorer.motion.limit_motions import limit_motion as limit_motion
    from explorer.motion.passages import passages as passages
    from explorer.motion.periods import periods as periods
    from explorer.motion.scan import scan as scan
    from explorer.motion.trajectories import simulate as simulate
    from explorer.phase.constants import constants as constants
    from explorer.phase.coordinates import coordinates_to_states as coordinates_to_states
    from explorer.phase.coordinates import rates_to_states as rates_to_states
    from explorer.phase.disk import Disk as Disk
    from explorer.phase.membership import falls as falls
    from explorer.phase.states import States as States
    from explorer.phase.states import StateWarning as StateWarning
    from explorer.phase.states import constants_to_states as constants_to_states
    from explorer.phase.states import phi_to_states as phi_to_states
    from explorer.phase.states import theta_to_states as theta_to_states
    from explorer.portrait.both_sides import both_sides as both_sides
    from explorer.portrait.rolling import circular_rolling as circular_rolling
    from explorer.portrait.rolling import steady_motions as steady_motions
    from explorer.portrait.slices import slice_map as slice_map
    from explorer.runs.merge import merge as merge
    from explorer.runs.run import Run as Run
    from explorer.runs.run import open as open
    from explorer.scenes.registry import register as register
    from explorer.view.page import view as view

    Status = _status.Status
    __version__: str

# Every public name, with the module it comes from; after a colon, what it is called there if not the same. `plot`
# and `portrait` are modules themselves.
_HOMES = {
    "CoarseTimesWarning": "errors",
    "Disk": "phase.disk",
    "InputError": "errors",
    "Interrupted": "errors",
    "Run": "runs.run",
    "RunError": "errors",
    "StateWarning": "phase.states",
    "States": "phase.states",
    "Status": "compiled:status.Status",
    "both_sides": "portrait.both_sides",
    "bounces": "motion.bounces",
    "circular_rolling": "portrait.rolling",
    "cite": "commands.cite",
    "constants": "phase.constants",
    "constants_to_states": "phase.states",
    "coordinates_to_states": "phase.coordinates",
    "falling_constant": "measure.falling_constant",
    "falls": "phase.membership",
    "flow_stretch": "measure.invariance",
    "limit_motion": "motion.limit_motions",
    "merge": "runs.merge",
    "open": "runs.run",
    "passage_forces": "motion.forces",
    "passages": "motion.passages",
    "periods": "motion.periods",
    "phi_to_states": "phase.states",
    "plan": "commands.plan",
    "plot": "plot",
    "portrait": "portrait",
    "push_forward": "measure.invariance",
    "rates_to_states": "phase.coordinates",
    "register": "scenes.registry",
    "run": "commands.run",
    "scan": "motion.scan",
    "simulate": "motion.trajectories",
    "slice_map": "portrait.slices",
    "steady_motions": "portrait.rolling",
    "theta_to_states": "phase.states",
    "trade": "commands.trade",
    "view": "view.page",
}

__all__ = [*_HOMES]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from explorer.version import installed_version

        value: Any = installed_version() or "0+unknown"
    elif name in _HOMES:
        home, _, path = _HOMES[name].partition(":")
        module = import_module(f"explorer.{home}")
        value = module if name == home else attrgetter(path or name)(module)
    else:
        raise AttributeError(f"module 'explorer' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


class _Package(ModuleType):
    """This package, whose room `view` never takes the place of the function of that name.

    The import system sets each room on its package as an attribute. Without one, `__getattr__` gives the function.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if name != "view" or not isinstance(value, ModuleType):
            super().__setattr__(name, value)

    def __reduce__(self) -> tuple[Callable[[str], ModuleType], tuple[str]]:
        """Packed by its name, like any module, for code of a user that travels to other processes."""
        return import_module, (self.__name__,)


sys.modules[__name__].__class__ = _Package
