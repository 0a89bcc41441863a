"""What users may give: sensible and extreme numbers, arrays, disks, states, and what is no number at all."""

import math
import os
import warnings

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

import explorer as ex

EXAMPLES = int(os.environ.get("NEARFLAT_EXAMPLES", "300"))  # of all properties together

DISKS = (
    ex.Disk.uniform(),
    ex.Disk.hoop(),
    ex.Disk.matching(),
    ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81),
    ex.Disk(I1=0.5, I3=0.3, name="thick"),
    ex.Disk(I1=0.3, I3=0.0, name="needle"),
    ex.Disk(I1=1e-6, I3=2e-6, name="core"),
    ex.Disk(I1=1e6, I3=1e6, name="rim"),
    ex.Disk(I1=0.25, I3=1e-9, name="rod"),
)
EXTREME = (
    *(0.0, -0.0, 5e-324, 1e-310, 1e-150, 1e-20, 1e-9, 0.5 * math.pi, math.pi, 1e3, 1e9, 1e100, 1e155, 1e308),
    *(-1e-9, -1.0, -1e9, -1e308, math.inf, -math.inf, math.nan, 2**63, np.float32(1e38), np.float32(0.3)),
)
numbers = st.floats(-2.0, 2.0) | st.sampled_from(EXTREME)
arrays = (
    st.lists(numbers, min_size=3, max_size=3).map(np.array)
    | st.lists(numbers, max_size=3)
    | st.lists(numbers, min_size=6, max_size=6).map(lambda six: np.array(six, float).reshape(2, 3))
    | st.sampled_from([np.array([1, 2, 3]), np.array([0.3, 0.4, 0.5], np.float32), np.empty((0, 3)), range(3)])
)
columns = st.floats(-2.0, 2.0) | numbers | arrays
# Of no type that an argument could have.
senseless = st.sampled_from(
    (
        *(None, True, "", "x", "1,5", b"1", 1j, (), ["a"], [[0.1], [0.2, 0.3]], {}, {"phi": 0.1}, object),
        *(np.array(["0.1", "b"]), np.array([1.0, 1.0j]), np.timedelta64(5, "ns"), ex.Disk.uniform()),
    )
)


@st.composite
def states(draw, rows=3):
    """States of one disk, some of them at the ends of what doubles hold."""
    disk, several = draw(st.sampled_from(DISKS)), st.lists(numbers, min_size=rows, max_size=rows)
    with warnings.catch_warnings(action="ignore", category=ex.StateWarning):
        if disk.I3 > 0.0 and draw(st.booleans()):
            distance = draw(st.sampled_from([1e-3, -1e-9, 1e-200, 0.0, 0.3]))
            return ex.constants_to_states(disk, draw(several), distance, 0.7)
        return ex.phi_to_states(disk, draw(st.floats(-1.0, 1.0)), *(draw(several) for _ in range(3)))


state_on_f = st.builds(
    ex.constants_to_states, st.sampled_from(DISKS[:4]), st.floats(-2.0, 2.0), st.just(0.0), st.just(0.7)
)
scalars = st.floats(0.1, 2.0) | numbers
boxes = st.sampled_from([None, "phi=-0.3:0.3", "phi=0.2,sigma3=0.3"])
# Sensible arguments by their names; any other is a column of numbers.
SENSIBLE = {
    "disk": st.sampled_from(DISKS),
    "states": states(),
    "state": state_on_f,
    "state_on_f": state_on_f,
    "side": st.sampled_from([1, -1]),
    "face": st.sampled_from([1, -1, [1, -1, 1]]),
    "degrees": st.booleans(),
    "accuracy": st.sampled_from([1e-3, 1e-6, 1e-9]),
    "method": st.sampled_from(["auto", "quadrature", "dopri5", "dop853", "rk8", "rk4"]),
    "window": st.sampled_from([None, 0.5]),
    "jobs": st.sampled_from([1, 2]),
    "count": st.sampled_from([1, 2, 5]),
    "t_end": st.sampled_from([0.5, 2.0, None]),
    "t_eval": st.sampled_from([None, [0.5, 1.0]]),
    "max_steps": st.sampled_from([10, 1000]),
    "observables": st.sampled_from([("phi",), ("phi", "chi", "contact"), ["sigma3"]]),
    "observable": st.sampled_from(["theta_min", "energy", "race_angle"]),
    "batch": st.sampled_from([1, 4096]),
    "steps": st.sampled_from([1, 20]),
    "step": st.sampled_from([0.05, 1.0]),
    "time": st.sampled_from([0.3, 1.0]),
    "samples": st.sampled_from([60, 200]),
    "seed": st.sampled_from([0, 7]),
    "rng": st.sampled_from([0, 7]),
    "box": boxes,
    "slice": st.sampled_from(
        ["phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2", "phi=0.1,phidot=-1:1,sigma3=-1:1,sigma4=0.5"]
    ),
    "points": st.sampled_from([3, 5]),
    "text": st.sampled_from(["uniform", "annulus:0.4", "m=1,r=2,I1=1,I3=flat", "hoop:m=2", "unifrom", "hoop:m=x"]),
    "scene": st.sampled_from(["race-angles", "falling-set"]),
    **dict.fromkeys(("I1", "I3", "m", "r", "g", "inner", "lean", "radius"), scalars),
    "chunk_size": st.sampled_from([32, 128]),
}


# What is no number: an argument with such a name is of no sensible type where it gets one.
WORDS = {
    "disk",
    "states",
    "state",
    "state_on_f",
    "method",
    "observables",
    "observable",
    "box",
    "slice",
}
WORDS |= {"scene", "text", "degrees"}


@st.composite
def keywords(draw, names):
    """Keyword arguments of a call, and whether one is of no sensible type.

    names: those with ? may be left out, those with ! are always sensible.
    """
    wanted = [name for name in names.split() if name[-1] != "?" or draw(st.integers(0, 2)) == 0]
    given = {name.rstrip("?!"): draw(SENSIBLE.get(name.rstrip("?!"), columns)) for name in wanted}
    kind = draw(st.sampled_from([None, None, columns, senseless]))
    name = draw(st.sampled_from([name.rstrip("?") for name in wanted if name[-1] != "!"]))
    if kind is not None:
        given[name] = draw(kind)
    return given, kind is senseless or (kind is columns and name in WORDS)


def examples(share):
    """So many of all examples."""
    return settings(max_examples=max(2, round(share * EXAMPLES)))
