"""Pictures of something else than they draw."""

import pytest

import explorer as ex
from explorer.plot.drawn import require_drawable

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
    with pytest.raises(ex.InputError) as refused:
        draw(found)
    assert f"{draw.__name__}: {origin}" in str(refused.value)
    assert str(refused.value).endswith("; a Constants was given")


def test_a_sequence_is_refused_for_one_entry_of_another_kind():
    one = ex.portrait.on_line(DISK, 1.0, 0.1)
    require_drawable(ex.plot.potential_curves, [one, one])
    require_drawable(ex.plot.potential_curves, iter([one]))
    for wrong in ([one, DISK], {"one": one}, one, "one"):
        with pytest.raises(ex.InputError, match="potentials must be sequence of Potential, from"):
            require_drawable(ex.plot.potential_curves, wrong)


def test_what_has_a_reader_of_its_own_is_left_to_it():
    require_drawable(ex.plot.definitions, 3)
    require_drawable(ex.plot.race_angle_histogram, 3)


def test_a_picture_of_a_user_may_say_nothing_of_its_argument():
    def draw(rows):
        return rows

    require_drawable(draw, [1.0])
