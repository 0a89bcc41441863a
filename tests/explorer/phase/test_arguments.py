"""Arrays as users give them: read exactly, or refused in a sentence; never cut, never changed."""

import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pandas as pd
import pytest

from explorer.errors import InputError
from explorer.phase.arguments import column, read_columns, returned_numbers


@pytest.mark.parametrize(
    "given",
    [
        [0.5, 2.0],
        (Fraction(1, 2), Decimal(2)),
        np.array([0.5, 2.0], ">f8"),
        np.array([0.5, 2.0], np.float16),
        np.array([0.5, 2.0], np.longdouble),
        pd.Series([0.5, 2.0]),
        pd.array([0.5, 2.0], dtype="Float64"),
        np.ma.array([0.5, 2.0]),
        np.array([0.5, 2.0], object),
    ],
    ids=lambda value: type(value).__name__,
)
def test_whatever_holds_doubles_is_read_as_they_are(given):
    read = column("phi", given)
    assert read.dtype == np.float64
    np.testing.assert_array_equal(read, [0.5, 2.0])


@pytest.mark.parametrize(
    "given",
    [
        np.ma.array([1.0, 2.0], mask=[False, True]),
        pd.array([1.0, None], dtype="Float64"),
        pd.Series([1, None], dtype="Int64"),
        [1.0, None],
        np.array([1.0, pd.NA], object),
    ],
    ids=["masked", "NA", "integers with NA", "None", "objects with NA"],
)
def test_what_is_missing_is_no_number_and_the_rest_is(given):
    np.testing.assert_array_equal(column("phi", given), [1.0, np.nan])


@pytest.mark.parametrize(
    "given",
    [1j, [1.0, 0j], True, [True, False], "1", ["1.0"], pd.Series(["a"]), [[1.0], [1.0, 2.0]], object()],
    ids=lambda given: type(given).__name__,
)
def test_what_is_no_real_number_is_refused_in_a_sentence(given):
    with pytest.raises(InputError, match=r"^phi = .* is not an array of real numbers"):
        column("phi", given)


@pytest.mark.parametrize(("given", "remedy"), [(["1.0"], "give numbers, not text"), (1j, "give numbers")])
def test_the_remedy_for_what_is_no_number_says_what_would_do(given, remedy):
    with pytest.raises(InputError, match=f"; {remedy}$"):
        column("phi", given)


def test_what_a_function_returned_keeps_its_type_and_is_numbers_or_bools():
    for given in (np.array([1, -1], np.int8), np.array([True]), np.array([math.nan, math.inf])):
        assert returned_numbers("density", given) is given
    np.testing.assert_array_equal(returned_numbers("density", np.ma.array([1, 2], mask=[0, 1])), [1.0, math.nan])
    for wrong in ([1j], ["a"], None):
        with pytest.raises(InputError, match="density: the function returned"):
            returned_numbers("density", wrong)


def test_columns_have_the_shape_to_which_arguments_broadcast():
    (phi, rate), shape = read_columns(phi=np.zeros((3, 1)), phidot=[1.0, 2.0])
    assert shape == (3, 2)
    np.testing.assert_array_equal(rate, [1.0, 2.0] * 3)
    assert phi.shape == (6,)
    assert read_columns(phi=1.0)[1] == ()


def test_what_was_given_is_not_what_is_returned():
    given = np.array([1.0, 2.0])
    (read,), _ = read_columns(phi=given)
    read[0] = 7.0
    np.testing.assert_array_equal(given, [1.0, 2.0])


def test_a_table_that_no_memory_holds_is_refused_at_once():
    with pytest.raises(InputError, match=r"broadcast to \(100000, 100000\); give up to"):
        read_columns(phi=np.zeros((100_000, 1)), phidot=np.zeros(100_000))
