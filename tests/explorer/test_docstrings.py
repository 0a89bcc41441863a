"""Help of public names: it names what they take and hold, and its examples print what they say."""

import doctest
import inspect
import re
import typing
from types import ModuleType
from unittest.mock import patch

import pytest

import explorer as ex
from explorer.scenes import scene as scenes

SECTION = re.compile(r"^(\w[\w ]*)\n-{3,}$", flags=re.MULTILINE)


def results(function):
    """Classes of this package that a function returns, and those that they return when they are called."""
    try:
        returned = typing.get_type_hints(function).get("return")
    except NameError:  # a type that only type checkers import
        return
    for kind in typing.get_args(returned) or (returned,):
        if inspect.isclass(kind) and kind.__module__.startswith("explorer."):
            yield kind
            # A motion that is called gives motions again
            if "__call__" in dir(kind) and not getattr(function, "__qualname__", "").startswith(kind.__name__):
                yield from results(kind.__call__)


def documented():
    """name -> object, for all public functions and classes and all result classes."""
    public = {name: getattr(ex, name) for name in ex.__all__}
    public = {name: value for name, value in public.items() if not isinstance(value, ModuleType)}
    public |= {"pictures": type(ex.pictures), "Picture": type(ex.pictures["rotation"])}
    for value in list(public.values()):
        public |= {kind.__name__: kind for kind in results(value) if inspect.isfunction(value)}
    return public


OBJECTS = documented()
NAMES = sorted(OBJECTS)


def sections(value):
    """Title -> text of the sections of a numpydoc docstring; the summary has the title ''."""
    parts = SECTION.split(inspect.getdoc(value))
    return dict(zip(["", *parts[1::2]], [part.strip() for part in parts[::2]], strict=True))


def named(text):
    """The names that a section lists: those at the margin, before a colon."""
    entries = re.findall(r"^(\S[^:\n]*?)(?: :|$)", text, flags=re.MULTILINE)
    return {name.strip().lstrip("*") for entry in entries for name in entry.split(",")}


def fields(kind):
    """Public attributes that a class declares."""
    declared = {name for base in kind.__mro__ for name in inspect.get_annotations(base)}
    return {name for name in declared if not name.startswith("_")}


@pytest.mark.parametrize("name", [name for name in NAMES if inspect.isfunction(OBJECTS[name])])
def test_help_names_what_a_function_takes(name):
    assert named(sections(OBJECTS[name]).get("Parameters", "")) == set(inspect.signature(OBJECTS[name]).parameters)


@pytest.mark.parametrize("name", [name for name in NAMES if inspect.isclass(OBJECTS[name])])
def test_help_names_what_a_class_holds(name):
    found = sections(OBJECTS[name])
    assert named(found.get("Attributes", "")) | named(found.get("Parameters", "")) >= fields(OBJECTS[name])


def of_methods():
    """name -> text, for methods of public classes, also of what these inherit, whose help has an example."""
    bases = {base for kind in OBJECTS.values() if inspect.isclass(kind) for base in kind.__mro__}
    helps = {
        f"{kind.__name__}.{each}": inspect.getdoc(value)
        for kind in sorted(bases, key=repr)
        if kind.__module__.startswith("explorer")
        for each, value in vars(kind).items()
    }
    return {name: text for name, text in helps.items() if text and ">>> " in text}


EXAMPLES = {name: inspect.getdoc(value) for name, value in OBJECTS.items()} | of_methods()


def test_methods_of_disks_states_and_runs_have_examples():
    for name in (
        "Disk.parse",
        "Disk.annulus",
        "Disk.from_ratios",
        "States.reversed",
        "Shaped.__getitem__",
        "Run.frame",
        "Run.verify",
    ):
        assert name in EXAMPLES


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_run_and_print_what_they_say(name):
    example = doctest.DocTestParser().get_doctest(EXAMPLES[name], {}, name, None, 0)
    assert example.examples
    report = []
    with patch.dict(scenes._own):  # an example may register a scene, which other tests must not see
        doctest.DocTestRunner(verbose=False).run(example, out=report.append)
    assert not report, "".join(report)
