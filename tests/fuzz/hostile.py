"""Objects that fail when they are looked at, that hold themselves, or that no encoding can write.

Each kind of value that a reader may meet, text, a number, a list, a mapping, an array or a path, comes once for
each method of its own that may raise: a reader asks one after the other, and any of them may be what fails.
"""

import weakref
from collections.abc import Mapping, Sequence

import numpy as np

import explorer as ex

DEEP = 100_000  # more than Python's own limit of recursion, and than its stack holds
# Methods, and attributes that are computed; "everything" is any of them, as that of a proxy of what has gone.
METHODS = (
    *("__float__", "__index__", "__int__", "__complex__", "__len__", "__iter__", "__getitem__", "__contains__"),
    *("__array__", "__fspath__", "__str__", "__repr__", "__format__", "__bool__", "__eq__", "__ne__", "__lt__"),
    *(
        "__gt__",
        "__le__",
        "__ge__",
        "__hash__",
        "__call__",
        "__neg__",
        "__abs__",
        "__add__",
        "__mul__",
        "__truediv__",
    ),
    *("__round__", "__reduce_ex__", "__array_ufunc__", "__instancecheck__", "__copy__", "__deepcopy__"),
    *("item", "keys", "items", "values", "get", "split", "strip", "encode", "replace", "startswith", "partition"),
    *("is_integer", "bit_length", "tolist", "to_numpy", "describe", "lower"),
)
ATTRIBUTES = ("shape", "dtype", "ndim", "size", "mask", "columns", "natural", "__array_interface__")
FAILURES = (
    *(RuntimeError, ValueError, TypeError, KeyError, AttributeError, IndexError, OSError, RecursionError),
    *(
        ZeroDivisionError,
        StopIteration,
        NotImplementedError,
        MemoryError,
        EOFError,
        ReferenceError,
        AssertionError,
    ),
    *(UserWarning, ex.InputError, ex.RunError),
)
BASES = (
    object,
    str,
    int,
    float,
    list,
    tuple,
    dict,
    set,
    np.ndarray,
    Mapping,
    Sequence,
    "path",
    "function",
    "number",
)


def _failing(failure):
    def fails(self, *given, **named):
        raise failure("no")

    return fails


def _like(base):
    """What a class of this kind needs besides, so that readers take it for one."""
    if base is Mapping or base is Sequence:
        entries = {"phi": 0.1} if base is Mapping else ["phi", 0.2]
        body = {
            "__getitem__": lambda self, key: entries[key],
            "__len__": lambda self: len(entries),
            "__iter__": lambda self: iter(entries),
        }
        return (base,), body
    own = {
        "path": {"__fspath__": lambda self: "no such folder/x.npz"},
        "function": {"__call__": lambda self, *given: np.ones(np.shape(given[0]) if given else ())},
        "number": {
            "__float__": lambda self: 0.3,
            "__index__": lambda self: 1,
            "__array__": lambda self, *_, **__: np.ones(2),
        },
    }
    return ((object,), own[base]) if base in own else ((base,), {})


def _made(kind, base):
    """An object of a class, which holds what a sensible one of this kind would."""
    if base is np.ndarray:
        return np.array([0.2, 0.3]).view(kind)
    given = {
        str: "phi=0.1",
        int: 1,
        float: 0.3,
        list: [0.1, 0.3],
        tuple: (0.1, 0.3),
        dict: {"phi": 0.1},
        set: {0.1},
    }
    return kind(given[base]) if base in given else kind()


def failing(base, method, failure=RuntimeError):
    """An object like a `base` whose `method` raises."""
    bases, body = _like(base)
    if method == "everything":
        body = body | {name: _failing(failure) for name in METHODS}
        body |= {name: property(_failing(failure)) for name in ATTRIBUTES}
    elif method in ATTRIBUTES or method == "__class__":
        body = body | {method: property(_failing(failure))}
    else:
        body = body | {method: _failing(failure)}
    return _made(type("Failing", bases, body), base)


def _nested(make, depth):
    value = 0.1
    for _ in range(depth):
        value = make(value)
    return value


def _of_itself(kind):
    value = kind()
    if kind is list:
        value.append(value)
    else:
        value["phi"] = value
    return value


def _beside_itself():
    """A dict and a list that hold one another, and a number."""
    mapping = {"phi": 0.1}
    mapping["sigma3"] = [0.1, mapping]
    return mapping


def _array_of(*entries):
    made = np.empty(len(entries), object)
    for place, entry in enumerate(entries):
        made[place] = entry
    return made


def _array_of_itself():
    value = _array_of(None, 0.1)
    value[0] = value
    return value


def _gone():
    return weakref.proxy(type("Gone", (), {})())


class Endless:
    """A sequence that never ends; what it says of its length is wrong."""

    def __len__(self):
        return 2

    def __getitem__(self, row):
        return 0.1


class Lying:
    """It says that it has other types, lengths and shapes than it has."""

    shape, ndim, dtype, size, columns = "x", "y", None, -1, None

    def __len__(self):
        return -1

    def __float__(self):
        return "0.1"

    def __index__(self):
        return 0.5

    def __fspath__(self):
        return b"x"

    def __array__(self, *given, **named):
        return "x"

    def __bool__(self):
        return 2

    def __hash__(self):
        return "x"

    def __repr__(self):
        return 7

    def __iter__(self):
        return 7

    def keys(self):
        return 7


UNWRITTEN = ("\ud800", "phi=\udcff", "\udcff.npz", "/tmp/\ud800.npz", "uniform:name=\ud800", "x\udfff" * 50)
SHAPES = (
    lambda: _of_itself(list),
    lambda: _of_itself(dict),
    _beside_itself,
    _array_of_itself,
    lambda: _nested(lambda v: [v], DEEP),
    lambda: _nested(lambda v: (v,), DEEP),
    lambda: _nested(lambda v: {"phi": v}, DEEP),
    lambda: _nested(lambda v: [v], 900),
    lambda: {"phi": _nested(lambda v: [v], DEEP)},
    lambda: "[" * DEEP,
    _gone,
    Endless,
    Lying,
    lambda: {Lying: 1},
    lambda: {None: 0.1},
    lambda: {1: (0.1, 0.2), "phi": 2},
    lambda: {"phi": failing(float, "everything")},
    lambda: [failing(object, "everything"), 0.1],
    lambda: (failing("number", "__float__"), 0.1),
    lambda: _array_of(failing(object, "everything")),
    lambda: {"phi": _array_of(failing(float, "__float__"))},
    lambda: [UNWRITTEN[0]],
    lambda: {UNWRITTEN[0]: 0.1},
    lambda: {"phi": UNWRITTEN[1]},
    lambda: np.array([UNWRITTEN[0]]),
    *(lambda text=text: text for text in UNWRITTEN),
)


def every(failure=RuntimeError):
    """(what it is, the object), each kind once; made anew, since some of them change when they are used."""
    for number, shape in enumerate(SHAPES):
        yield f"shape {number}", shape()
    for base in BASES:
        for method in ("everything", "__class__", *METHODS, *ATTRIBUTES):
            try:
                value = failing(base, method, failure)
            except Exception:  # some have a method that making them asks
                continue
            yield f"{base if isinstance(base, str) else base.__name__} {method}", value


def any_of(random):
    """One of all these, with any failure."""
    if random.random() < 0.4:
        return random.choice(SHAPES)()
    while True:
        method = random.choice(("everything", "__class__", *METHODS, *ATTRIBUTES))
        try:
            return failing(random.choice(BASES), method, random.choice(FAILURES))
        except Exception:
            continue
