"""A few cases of each kind, the same each time, and the harness finds a planted fault of each kind.

`python -m tests.fuzz --cases 100000` tries many more.
"""

import random
import time
import warnings
from collections import Counter

import numpy as np
import pytest

import explorer as ex
from fuzz import api, commands, folders, hostile, judge, kernels, methods, plots, values

DISK = ex.Disk.uniform()


def faults(cases):
    """Faults among the cases, and the counts of all verdicts."""
    found = list(cases)
    return [case for case in found if case[2].kind in judge.FAULTS], Counter(case[2].kind for case in found)


def test_functions_answer_or_refuse_in_a_sentence():
    bad, counts = faults(api.run(1100, seed=11))
    assert not bad
    assert counts["value"] > 200
    assert counts["refused"] > 400


def test_functions_that_take_long_refuse_before_they_begin():
    bad, counts = faults(api.run(60, seed=4, only=api.LONG))
    assert not bad
    assert counts["refused"] > 40


def test_every_public_function_is_among_the_cases():
    called = {name for name, _, _ in api.run(0)} | set(api.functions())
    public = {
        name for name in ex.__all__ if callable(getattr(ex, name)) and not isinstance(getattr(ex, name), type)
    }
    assert public - called - api.FOLDERS <= {"plot", "view"}
    assert {f"portrait.{name}" for name in ex.portrait.__all__} <= called
    assert {f"plot.{name}" for name in ex.plot.__all__} <= called
    assert set(ex.plot.__all__) == plots.SENSIBLE.keys() | plots.UNDRAWN.keys()


def test_every_argument_is_given_now_and_then():
    rng = random.Random(5)
    for name in api.TOGETHER:
        call = api.functions()[name]
        given = set().union(*(api.case(name, call, rng) for _ in range(200)))
        assert given == set(api.arguments_of(call))


def test_methods_are_given_what_they_take():
    """By the names that they have; what a method returns for sensible arguments is a value, or a refusal."""
    rng = random.Random(3)
    for name in methods.METHODS:
        given = {each: methods.SENSIBLE.get(each, values.size)(rng) for each in methods.METHODS[name]}
        assert judge.judge(methods.method(name), given).kind in ("value", "refused")


def test_kernels_return_whatever_doubles_they_get():
    assert not faults(kernels.run(750, seed=11))[0]


def test_command_lines_end_with_a_sentence(tmp_path):
    assert not faults(commands.run(60, 11, tmp_path))[0]


def test_edited_folders_end_with_a_sentence(tmp_path):
    bad, counts = faults(folders.run(80, 11, tmp_path))
    assert not bad
    assert set(counts) == {"value", "refused"}


def test_spoilt_files_of_states_end_with_a_sentence(tmp_path):
    assert not faults(folders.run_states(40, 11, tmp_path))[0]


def changes(phi):
    phi[0] = 2.0


def works(phi):
    end = time.process_time() + 0.05
    while time.process_time() < end:
        pass


def sleeps(phi):
    time.sleep(0.5)


def warns(phi):
    warnings.warn("cut", RuntimeWarning, stacklevel=1)


def fails(phi):
    return phi.nonsense


def tells_a_story(phi):
    error = ex.InputError("phi")
    error.__class__ = type("Long", (ex.InputError,), {"__str__": lambda _: "x" * 301})
    raise error


def gives_nan(phi):
    found = ex.constants(ex.phi_to_states(DISK, 0.0, 1.0, 1.0, phi))
    found.energy[0] = np.nan
    return found


@pytest.mark.parametrize(
    ("planted", "kind"),
    [
        (fails, "traceback"),
        (warns, "warning"),
        (tells_a_story, "too long a message"),
        (works, "hang"),
        (sleeps, "hang"),
        (gives_nan, "not finite"),
        (changes, "changed argument"),
    ],
)
def test_a_planted_fault_of_each_kind_is_found(planted, kind, monkeypatch):
    monkeypatch.setattr(judge, "SLOWEST", 0.04 if kind == "hang" else judge.SLOWEST)
    assert judge.judge(planted, {"phi": np.array([1.0, 0.5])}).kind == kind
    monkeypatch.undo()
    assert judge.judge(lambda phi: phi + 1.0, {"phi": np.array([1.0, 0.5])}).kind == "value"


def test_a_reader_that_trusts_what_it_is_given_is_found():
    """By objects that fail when they are looked at, that hold themselves, and by text that is no UTF-8."""

    def trusts(phi):
        return sum(phi.values()) if isinstance(phi, dict) else float(phi) if len(phi) else str(phi).encode()

    def careful(phi):
        return ex.phi_to_states(DISK, phi, 1.0, 1.0, 0.7)

    chosen = [value for number, (_, value) in enumerate(hostile.every()) if number < 30 or number % 9 == 0]
    assert {judge.judge(careful, {"phi": value}).kind for value in chosen} == {"value", "refused"}
    assert sum(judge.judge(trusts, {"phi": value}).kind == "traceback" for value in chosen) > 50


def test_objects_that_fail_are_among_the_cases():
    rng = random.Random(2)
    kinds = [type(values.nasty(rng)) for _ in range(300)]
    assert sum(kind.__module__ == hostile.__name__ for kind in kinds) > 5


def test_planted_faults_are_found_where_cases_are_made(monkeypatch, tmp_path):
    """In a function that is tried, in a command, and in what reads a folder."""
    from explorer.runs import store

    monkeypatch.setattr(api, "functions", lambda: {"phi_to_states": fails})
    assert faults(api.run(5))[1] == {"traceback": 5}
    monkeypatch.setattr("explorer.commands.columns.call", lambda options: 3)
    assert judge.judge_command(["columns"]).kind == "traceback"
    good = folders.small_run(tmp_path / "run")
    monkeypatch.setattr(store, "read_json", lambda text: text.nonsense)
    assert judge.judge_command(["status", str(good)]).kind == "traceback"
