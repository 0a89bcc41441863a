"""nearflat: a Monte Carlo explorer of the rolling disk's phase space.

    import explorer as ex
    disk = ex.Disk.uniform()
    ex.constants(disk, phi=0.0, phidot=1.0, sigma3=1.0, sigma4=0.7)
    ex.run("race-angles", disk=disk, samples=100_000)

Names are loaded on first use, so that importing this package is cheap.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from explorer import plot as plot
    from explorer.api import run as run
    from explorer.disk import Disk as Disk
    from explorer.errors import InputError as InputError
    from explorer.errors import RunError as RunError
    from explorer.falling import falls as falls
    from explorer.falling_constant import falling_constant as falling_constant
    from explorer.invariance import flow_stretch as flow_stretch
    from explorer.invariance import push_forward as push_forward
    from explorer.limits import limit_motion as limit_motion
    from explorer.motions import simulate as simulate
    from explorer.passage import passage_forces as passage_forces
    from explorer.passage import passages as passages
    from explorer.passage import periods as periods
    from explorer.states import constants as constants
    from explorer.states import constants_to_states as constants_to_states
    from explorer.states import phi_to_states as phi_to_states
    from explorer.states import theta_to_states as theta_to_states

_HOMES = {
    "Disk": "disk",
    "InputError": "errors",
    "RunError": "errors",
    "constants": "states",
    "constants_to_states": "states",
    "falls": "falling",
    "falling_constant": "falling_constant",
    "flow_stretch": "invariance",
    "limit_motion": "limits",
    "passage_forces": "passage",
    "passages": "passage",
    "periods": "passage",
    "phi_to_states": "states",
    "plot": "",
    "push_forward": "invariance",
    "run": "api",
    "simulate": "motions",
    "theta_to_states": "states",
}

__all__ = ["Status", *sorted(_HOMES)]


def __getattr__(name: str) -> Any:
    if name == "Status":
        value = import_module("explorer.compiled").status.Status
    elif name in _HOMES:
        home = _HOMES[name]
        value = getattr(import_module(f"explorer.{home}"), name) if home else import_module(f"explorer.{name}")
    else:
        raise AttributeError(f"module 'explorer' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
