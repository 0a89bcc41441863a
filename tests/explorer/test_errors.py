"""Readers of what users write: what they accept, what they refuse, and that a message says all three things."""

import math
import pickle
from fractions import Fraction

import numpy as np
import pytest

from explorer.errors import (
    InputError,
    RunError,
    flag,
    number,
    one_of,
    positive,
    sign,
    suggest,
    whole,
)
from explorer.motion.plan import plan
from explorer.phase.arguments import read_range


@pytest.mark.parametrize(
    "value", [1e6, "1e6", 1_000_000, "1000000", " 1000000 ", np.int64(10**6), np.float32(1e6), np.array(1e6)]
)
def test_a_whole_number_may_be_written_in_any_way(value):
    assert whole("samples", value, 1, 10**12) == 1_000_000
    assert type(whole("samples", value, 1)) is int


def test_a_whole_number_as_text_keeps_all_its_digits():
    assert whole("seed", str(2**100 + 1)) == 2**100 + 1


@pytest.mark.parametrize(
    "value", [True, np.True_, "yes", 1.5, "1.5", None, [1], math.nan, math.inf, "1e400", "-1", 0]
)
def test_what_is_no_whole_number_in_its_bounds_is_refused_by_name_value_and_remedy(value):
    with pytest.raises(InputError) as refused:
        whole("samples", value, 1, 10)
    assert str(refused.value).startswith("samples = ")
    assert "number" in str(refused.value)


def test_a_number_beyond_its_bounds_is_answered_with_them():
    with pytest.raises(InputError, match=r"accuracy = 2\.0 .*from 0 to 1"):
        number("accuracy", 2.0, 0.0, 1.0)


@pytest.mark.parametrize("value", [0.25, "0.25", np.float64(0.25), np.array([0.25]), Fraction(1, 4)])
def test_a_number_may_be_of_any_type_that_holds_one(value):
    assert number("accuracy", value, 0.0, 1.0) == 0.25


@pytest.mark.parametrize(
    "value", [True, np.True_, None, "a lot", [1.0], np.zeros(2), 1j, math.nan, "inf", 10**400]
)
def test_what_is_no_finite_number_is_refused(value):
    with pytest.raises(InputError, match="accuracy = "):
        number("accuracy", value)


@pytest.mark.parametrize(
    "value",
    [np.ma.masked, np.ma.array(1.0, mask=True), np.ma.array([1], mask=True), np.ma.array([[1.0]], mask=[[1]])],
)
def test_a_masked_number_is_none(value):
    for read in (number, positive, whole, sign, flag):
        with pytest.raises(InputError, match=r"^m = "):
            read("m", value)
    assert number("m", np.ma.array(0.25)) == number("m", np.ma.array([0.25], mask=[False])) == 0.25


def test_a_positive_number_is_above_zero():
    assert positive("m", "1e-300") == 1e-300
    with pytest.raises(InputError, match=r"m = 0\.0 must be a finite number above 0"):
        positive("m", 0.0)


def test_a_flag_is_true_or_false_and_no_number():
    assert flag("well", True) is True
    with pytest.raises(InputError, match="well = 1 must be true or false"):
        flag("well", 1)


def test_an_unknown_word_is_answered_with_the_nearest_one():
    assert one_of("keep", "near", ("near", "all")) == "near"
    with pytest.raises(InputError, match=r"keep 'naer' is not known; did you mean 'near'\? known: near, all"):
        one_of("keep", "naer", ("near", "all"))
    with pytest.raises(InputError, match="keep 3"):
        one_of("keep", 3, ("near", "all"))
    assert suggest("zzz", ("near", "all")) == "known: near, all"


@pytest.mark.parametrize("value", ["-1e-3:2", (-1e-3, 2), [np.float64(-1e-3), "2"]])
def test_a_range_is_text_or_a_pair(value):
    assert read_range("energy", value) == (-1e-3, 2.0)


def test_one_number_is_a_range_of_one_point():
    assert read_range("box phi", "-0.5") == read_range("box phi", -0.5) == (-0.5, -0.5)


@pytest.mark.parametrize(
    ("value", "ends"),
    [
        (":3", (-math.inf, 3.0)),
        ("3:", (3.0, math.inf)),
        ((None, 2.0), (-math.inf, 2.0)),
        ((-math.inf, math.inf), (-math.inf, math.inf)),
    ],
)
def test_an_end_may_be_left_out_only_where_a_range_may_be_unbounded(value, ends):
    assert read_range("energy", value, unbounded=True) == ends
    with pytest.raises(InputError, match="is not a number or a range"):
        read_range("ladder", value)


@pytest.mark.parametrize("value", ["1:2:3", "a:b", "nan:1", (1.0,), None, (True, 2), "inf:inf", "", ":"])
def test_what_is_no_range_is_refused(value):
    with pytest.raises(InputError, match=r"ladder = .* is not a number or a range LOW:HIGH"):
        read_range("ladder", value)


def test_an_empty_range_is_refused():
    with pytest.raises(InputError, match="ladder = 2:1 is empty; give LOW:HIGH, the smaller number first"):
        read_range("ladder", "2:1")


@pytest.mark.parametrize("kind", [InputError, RunError])
def test_errors_come_whole_from_another_process(kind):
    assert str(pickle.loads(pickle.dumps(kind("eta_hat 1:2 is empty")))) == "eta_hat 1:2 is empty"


def test_a_face_is_read_as_any_number_is():
    assert [sign("face", value) for value in ("1", "-1e0", 1.0, np.int64(-1))] == [1, -1, 1, -1]
    for wrong in ("0", 2, "plus", float("nan"), None, True):
        with pytest.raises(InputError, match="face"):
            sign("face", wrong)


@pytest.mark.parametrize(
    ("text", "said"),
    [("1,000", "commas are not read, write 1000; "), ("-12,345,678", "write -12345678; "), ("0,5", "not read; ")],
)
def test_a_number_with_commas_is_answered_with_how_to_write_it(text, said):
    with pytest.raises(InputError, match="is not a number; commas are") as refused:
        whole("samples", text, 1)
    assert said in str(refused.value)


def test_the_beginning_of_a_name_is_taken_for_it():
    known = ("face", "race_angle", "eta_hat_plus", "eta_hat")
    assert suggest("race", known).startswith("did you mean 'race_angle'?")
    assert suggest("eta", known).startswith("did you mean 'eta_hat'?")
    assert suggest("fase", known).startswith("did you mean 'face'?")


@pytest.mark.parametrize(
    ("text", "count"), [("10k", 10_000), ("10K", 10_000), ("2.5M", 2_500_000), (" 3k ", 3000), ("1e3", 1000)]
)
def test_thousands_and_millions_may_be_written_short(text, count):
    assert whole("samples", text) == count


@pytest.mark.parametrize(
    ("written", "meant"), [("RK45", "dopri5"), ("DOP853", "dop853"), ("Quadrature", "quadrature")]
)
def test_a_word_of_another_case_or_program_is_told_what_it_is_here(written, meant):
    with pytest.raises(InputError, match=f"did you mean '{meant}'"):
        plan(("theta_min",), method=written)
