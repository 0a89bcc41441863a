"""What pictures are given: read at one door, and refused in a sentence that says what would do."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import explorer as ex
from explorer.plot.drawn import call, reads_arguments
from explorer.portrait.potential import Potential

DISK = ex.Disk.uniform()


@pytest.mark.parametrize(
    ("draw", "origin"),
    [
        (ex.plot.contact_paths, "both must be BothSides, from ex.both_sides"),
        (ex.plot.wander_path, "path must be WanderPath, from ex.portrait.wander_path"),
        (ex.plot.slice_map, "cut must be SliceMap, from ex.slice_map"),
        (ex.plot.observable_map, "found must be SliceMap or Scan, from ex.slice_map or ex.scan"),
        (ex.plot.race_deviation, "races must be mapping or sequence of mappings, the summary of a run"),
        (ex.plot.limit_paths, "several must be sequence of BothSides, from ex.portrait.toward_limits"),
        (ex.plot.hero, "shown must be Film, one bounce, from ex.portrait.film"),
    ],
)
def test_a_result_of_another_kind_is_refused_with_where_the_right_one_is_from(draw, origin):
    found = ex.constants(ex.constants_to_states(DISK, 1.0, 0.1, 1.0))
    first = next(iter(draw.__wrapped__.__annotations__))
    for given, named in (((found,), {}), ((), {first: found})):
        with pytest.raises(ex.InputError) as refused:
            draw(*given, **named)
        assert f"{draw.__name__}: {origin}" in str(refused.value)
        assert str(refused.value).endswith("; a Constants was given")


def test_a_sequence_is_refused_for_one_entry_of_another_kind_and_where_it_is_empty():
    def draw(potentials: Sequence[Potential]) -> list[Potential]:
        """Potentials.

        Parameters
        ----------
        potentials : sequence of Potential
            From `explorer.portrait.on_line`.
        """
        return potentials

    one = ex.portrait.on_line(DISK, 1.0, 0.1)
    assert call(draw, ([one, one],), {}) == call(draw, (iter([one, one]),), {}) == [one, one]
    for wrong in ([one, DISK], {"one": one}, one, "one", [], np.array([1.0])):
        with pytest.raises(ex.InputError, match="potentials must be sequence of Potential, from"):
            call(draw, (wrong,), {})


@pytest.mark.parametrize(
    ("name", "wrong", "says"),
    [
        ("bins", 0, "bins = 0 must be a whole number from 1 to 1000"),
        ("reach", (2.0, 1.0), "reach 2:1 is empty"),
        ("near", 1, "near = 1 must be true or false"),
        ("height", 1j, "height = 1j is not a number"),
        ("disk", "hoop", "disk = 'hoop' is not a Disk; make one"),
        ("ax", Figure(), "are no Axes of matplotlib; give some, or leave ax out"),
        ("marks", ["a"], "marks = .* is not an array of real numbers"),
        ("named", [1], "named = .*: give a dict of whole numbers to numbers"),
        ("nonsense", 1, "unexpected keyword argument 'nonsense'; it takes bins, reach, near, height"),
    ],
)
def test_every_argument_is_read_as_its_annotation_says(name, wrong, says):
    @reads_arguments
    def draw(
        bins: int = 3,
        reach: tuple[float, float] | None = None,
        near: bool = False,
        height: float = 1.0,
        disk: ex.Disk | None = None,
        ax: Axes | None = None,
        marks: Sequence[float] = (),
        named: Mapping[int, float] | None = None,
    ) -> Any:
        return bins, reach, near, height, disk, ax, marks, named

    read = draw("4", "1:2", True, "2e0", DISK, marks=(1, 2), named={"1": 2})
    assert read == (4, (1.0, 2.0), True, 2.0, DISK, None, [1.0, 2.0], {1: 2.0})
    with pytest.raises(ex.InputError, match=says):
        draw(**{name: wrong})


def test_what_only_matplotlib_and_the_picture_can_judge_is_refused_too_and_other_faults_are_not_hidden():
    @reads_arguments
    def draw(summary: dict[str, Any], **look: Any) -> float:
        return summary["x"] / look.get("lw", 1.0)

    assert draw({"x": 3.0}) == 3.0
    with pytest.raises(ex.InputError, match=r"draw: summary cannot be drawn \(KeyError: 'x'\)"):
        draw({})
    with pytest.raises(ex.InputError, match="draw: lw = 'a' or summary cannot be drawn"):
        draw({"x": 3.0}, lw="a")

    @reads_arguments
    def fails(bins: int) -> float:
        return bins / 0

    with pytest.raises(ZeroDivisionError):
        fails(3)


@pytest.mark.parametrize("kind", ["polar", "taken away", "logit"])
def test_axes_that_no_picture_can_use_are_refused(kind):
    axes = Figure().add_subplot(projection="polar" if kind == "polar" else None)
    if kind == "taken away":
        axes.remove()
    elif kind == "logit":
        axes.set_xscale("logit")
    with pytest.raises(ex.InputError, match="ax must be plain Axes"):
        ex.plot.steady_map(DISK, ax=axes)


def test_a_picture_of_a_user_may_say_nothing_of_its_argument():
    def draw(rows):
        return rows

    assert call(draw, ([1.0],), {}) == [1.0]
