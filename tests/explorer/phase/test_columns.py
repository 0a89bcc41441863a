"""What columns mean."""

import pytest

from explorer.errors import InputError
from explorer.phase.columns import COLUMNS, column


def test_every_column_has_a_sentence_and_its_unit_is_one_of_the_units_of_the_disk():
    units = {"", "rad", "rad/time", "time", "length", "energy", "mass length^2 rad/time", "length/time"}
    for name, known in COLUMNS.items():
        assert known.meaning.endswith("."), name
        assert known.unit in units, name


def test_an_unknown_column_is_refused_with_the_nearest_one():
    with pytest.raises(InputError, match="did you mean 'race_angle'"):
        column("race_angel")
