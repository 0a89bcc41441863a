"""Cases of what results can do: each method that takes arguments, of one result of each kind."""

from functools import cache

import explorer as ex

from .values import nasty, size

_COIN = ex.Disk.uniform()
_PLANE = "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2"


@cache
def owners():
    """One result of each kind, by the name of its class."""
    states = ex.constants_to_states(_COIN, [0.6, 0.7], 0.05, 1.0)
    on_f = ex.constants_to_states(_COIN, 1.0, 0.0, 1.0)
    return {
        "Disk": _COIN,
        "States": states,
        "Passages": ex.passages(_COIN, 1.0, [1e-2, -1e-2], 1.0),
        "Trajectories": ex.simulate(states, t_end=1.0),
        "LimitMotion": ex.limit_motion(on_f),
        "Scan": ex.scan(states, "theta_min"),
        "SliceMap": ex.slice_map(_COIN, _PLANE, points=3),
        "BothSides": ex.both_sides(on_f),
        "Film": ex.portrait.film(_COIN, frames=3),
        "Wander": ex.portrait.wander(states),
        "Potential": ex.portrait.on_line(_COIN, 0.25, 0.01),
        "View": ex.view("hoop"),
        "Run": ex.run("race-angles", samples=60),
    }


# Arguments by the name of the method; those that are sensible where the others are not.
METHODS = {
    "Disk.eta_hat_to_eta": ("eta_hat",),
    "Disk.eta_to_eta_hat": ("eta",),
    "Disk.energy_at_flat": ("sigma3_bar",),
    "States.__getitem__": ("rows",),
    "States.at": ("rows",),
    "Passages.save": ("path",),
    "Passages.reshaped": ("shape",),
    "Trajectories.__call__": ("t",),
    "LimitMotion.__call__": ("t",),
    "LimitMotion.impacts": ("t_end",),
    "Scan.__getitem__": ("name",),
    "SliceMap.__getitem__": ("name",),
    "BothSides.limit_path": ("side",),
    "Film.pose": ("sign", "row"),
    "Wander.after": ("count",),
    "Potential.V": ("phi",),
    "Potential.dV": ("phi",),
    "Potential.d2V": ("phi",),
    "Potential.rho": ("phi",),
    "Potential.at_y": ("y",),
    "Potential.falling_edge": ("y",),
    "Potential.flat_value": ("face",),
    "Potential.reach": ("face",),
    "Potential.components": ("energy",),
    "Potential.curve": ("component", "points"),
    "View.save": ("path",),
    "Run.arrow": ("columns",),
    "Run.frame": ("columns",),
    "Run.figure": ("name", "ax", "bins"),
    "Run.resume": ("jobs", "progress"),
    "new States": ("disk", "natural", "status"),
    "new Run": ("parts",),
    "merge": ("run",),
    "open": ("folder",),
    "register": ("scene",),
}
SENSIBLE = {
    "rows": lambda r: r.choice((0, 1, -1, slice(1), [0, 1], [True, False])),
    "path": lambda r: r.choice(("no such folder/x.npz", "x.y")),
    "shape": lambda r: r.choice(((2, 1), (1, 2), (2,))),
    "t": lambda r: r.choice((0.5, [0.1, 0.9], [[0.0], [1.0]])),
    "t_end": lambda r: r.choice((1.0, 7.0)),
    "name": lambda r: r.choice(("theta_min", "histogram", "nonsense")),
    "side": lambda r: r.choice((1, -1)),
    "face": lambda r: r.choice((1, -1)),
    "sign": lambda r: r.choice((1, -1)),
    "row": lambda r: r.choice((0, 1)),
    "count": lambda r: r.choice((0, 3)),
    "component": lambda r: r.choice(owners()["Potential"].components(2.0)),
    "points": lambda r: r.choice((2, 50)),
    "columns": lambda r: r.choice((None, ["theta_min"], ("status", "race_angle"))),
    "ax": lambda r: None,
    "bins": lambda r: r.choice((1, 5)),
    "jobs": lambda r: 1,
    "progress": lambda r: r.choice((None, False)),
    "disk": lambda r: _COIN,
    "natural": lambda r: owners()["States"].natural,
    "status": lambda r: owners()["States"].status,
    "parts": lambda r: r.choice((owners()["Run"].parts, [])),
    "run": lambda r: owners()["Run"],
    "folder": lambda r: "no such folder",
    "scene": lambda r: type("Own", (), {}),
}


def method(name):
    """What is called with the keywords of `METHODS[name]`."""
    owner, _, what = name.partition(".")
    if owner in ("merge", "open", "register"):
        return lambda **given: getattr(ex, owner)(*given.values())
    if not what:
        made = getattr(ex, owner.removeprefix("new "))
        return lambda **given: made(*given.values())
    return lambda **given: getattr(owners()[owner], what)(**given)


def case(name, rng):
    """Arguments of one call, in their order; one of them is often none."""
    arguments = METHODS[name]
    given = {each: SENSIBLE[each](rng) if each in SENSIBLE else size(rng) for each in arguments}
    if rng.random() < 0.8:
        given[rng.choice(arguments)] = nasty(rng)
    return given
