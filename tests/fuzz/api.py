"""Cases of the Python functions: every public one, found by its name and called by its signature."""

import inspect
import random
import re
import typing
import warnings
from types import ModuleType

import explorer as ex
from explorer import errors
from explorer.scenes.registry import SCENES, build_scene

from . import methods, plots
from .judge import judge
from .values import DISKS, nasty, sensible

# Public names that are not called here: they write or read folders, and command lines try them.
FOLDERS = {"run", "open", "merge", "register", "plan"}
# Names that take seconds or minutes, and arguments with which they end at once: one of the others is always
# spoilt, and is no number of passages that would take long. `trade` refuses so few samples before it draws any.
LONG = {
    "trade": {"samples": 3},
    "portrait.conservation": {"disk": ex.Disk.uniform(), "most": 2, "most_by_solver": 1, "accuracies": [1e-6]},
    "portrait.general_solvers": {"disk": ex.Disk.uniform(), "eta_hat": [0.1]},
}
# How often a function is tried, where it takes long: the others count as 1.
SELDOM = {"falling_constant": 0.004, "push_forward": 0.02, "slice_map": 0.1, "both_sides": 0.2}
SELDOM |= {"trade": 0.3, "view": 0.3, "simulate": 0.3, "limit_motion": 0.3}
SELDOM_OF_PORTRAITS = 0.03  # several periods of several motions each
SELDOM_OF_PICTURES = 0.03


def functions():
    """name -> what is called, for all public functions, makers of disks, and the options of all scenes."""
    public = {name: getattr(ex, name) for name in ex.__all__}
    found = {
        name: value
        for name, value in public.items()
        if inspect.isfunction(value) and not isinstance(value, ModuleType) and name not in FOLDERS
    }
    found |= {f"portrait.{name}": getattr(ex.portrait, name) for name in ex.portrait.__all__}
    makers = ("annulus", "uniform", "hoop", "matching", "parse")
    found |= {f"Disk.{name}": getattr(ex.Disk, name) for name in makers}
    found |= {"Disk": ex.Disk} | {f"scene {name}": scene_maker(name) for name in SCENES}
    found |= {f"plot.{name}": getattr(ex.plot, name) for name in ex.plot.__all__}
    return found | {f"method {name}": methods.method(name) for name in methods.METHODS}


def scene_maker(name):
    """What reads the options of a scene; nothing is computed."""

    def make(**options):
        return list(build_scene(name, **options).options())

    make.__signature__ = inspect.Signature(
        [inspect.Parameter(o.word, inspect.Parameter.KEYWORD_ONLY, default=None) for o in SCENES[name].OPTIONS]
    )
    return make


def arguments_of(function):
    """name -> whether it may be left out; keywords that travel together count each."""
    found = {}
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.kind is parameter.VAR_KEYWORD:
            for keys in typing.get_args(typing.get_type_hints(function)[name]):
                found |= dict.fromkeys(keys.__annotations__, True)
        elif parameter.kind is not parameter.VAR_POSITIONAL:
            found[name] = parameter.default is not parameter.empty
    return found


# Arguments that only make sense together.
TOGETHER = {
    "coordinates_to_states": lambda r: r.choice(
        (
            ("phi", "phidot", "sigma3", "sigma4"),
            ("energy", "sigma3_bar", "eta_hat"),
            ("phi", "phidot", "sigma3_bar", "sigma4_bar"),
        )
    ),
    "simulate": lambda r: (r.choice(("t_end", "t_eval")), "observables", "accuracy"),
}
# Those that may join them, each now and then.
BESIDES = {
    "coordinates_to_states": ("face",),
    "simulate": ("t_end", "t_eval", "chi0", "jobs", "max_steps", "method"),
}


def case(name, function, rng):
    """Keyword arguments of one call: most are sensible, one or two often are not."""
    if name.startswith("plot."):
        return plots.case(name.removeprefix("plot."), rng)
    if name.startswith("method "):
        return methods.case(name.removeprefix("method "), rng)
    if name in LONG:
        return spoilt_case(name, rng)
    known = arguments_of(function)
    needed = [argument for argument, optional in known.items() if not optional]
    chosen = needed + [a for a in known if a not in needed and rng.random() < 0.3]
    if name in TOGETHER:
        joined = [argument for argument in BESIDES[name] if rng.random() < 0.3]
        chosen = list(dict.fromkeys((*needed, *TOGETHER[name](rng), *joined)))
    if name.startswith("scene "):
        chosen = rng.sample(list(known), 1)
    given = {argument: sensible(argument, rng) for argument in chosen if argument != "text"}
    if name == "Disk.parse":
        given["text"] = rng.choice(("uniform", "annulus:0.4", "m=1,r=2,I1=1,I3=flat", "hoop:m=2"))
    if name.startswith("portrait."):  # bodies whose races have a thousand turns, and methods for them, take long
        quick = {"disk": rng.choice(DISKS[:6]), "method": "auto"}
        given = {"points": 4, **given} if "points" in known else given
        given |= {word: value for word, value in quick.items() if word in given}
    if name.startswith("Disk"):
        given = {argument: abs(value) if isinstance(value, float) else value for argument, value in given.items()}
    spoilt = rng.choices((0, 1, 2), (0.25, 0.6, 0.15))[0]
    for argument in rng.sample(list(given), min(spoilt, len(given))):
        given[argument] = nasty(rng)
    return given


def spoilt_case(name, rng):
    """Keyword arguments of one call that takes long unless it is refused."""
    given = dict(LONG[name])
    others = {"trade": ("scene", "disk", "accuracy", "motions", "eta_hat")}.get(name, tuple(given))
    value = nasty(rng)
    while takes_long(value):
        value = nasty(rng)
    return given | {rng.choice(others): value}


def takes_long(value):
    """Whether it is read as a number of passages that is more than a few."""
    try:
        return errors.whole("most", value) > 9
    except errors.InputError:
        return False


def run(cases, seed=0, only=None):
    """(name, arguments, verdict) of so many calls, the same for the same seed."""
    table = {name: function for name, function in functions().items() if only is None or name in only}
    rooms = {"scene": 0.2, "portrait": SELDOM_OF_PORTRAITS, "plot": SELDOM_OF_PICTURES, "method": 0.05}
    weights = [SELDOM.get(name, rooms.get(re.split(r"\W", name)[0], 1.0)) for name in table]
    rng = random.Random(seed)
    if cases and any(name.startswith("method ") for name in table):
        methods.owners()  # made before the first call of a method, which is timed
    for _ in range(cases):
        name = rng.choices(list(table), weights)[0]
        given = case(name, table[name], rng)
        verdict = judge(table[name], given)
        yield name, given, verdict
        if name == "limit_motion" and verdict.kind == "value":
            with warnings.catch_warnings(action="ignore", category=ex.StateWarning):
                limit = ex.limit_motion(**given)
            times = {"t": rng.choice((sensible, lambda _, r: nasty(r)))("t", rng)}
            yield "limit_motion(...)", times, judge(limit, times)
