"""Misprints: each is decided by numbers, and the numbers can decide otherwise."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import explorer as ex
from explorer.paper.chaplygin_series import Chaplygin
from explorer.paper.misprint_evidence import FACTOR, Evidence
from explorer.paper.misprint_limits import lemma_2
from explorer.paper.misprints import MISPRINTS, misprints_page

PLACES = (
    *(
        "(2.12)",
        "(2.32)",
        "(2.35)",
        "3.4",
        "2.2, 2.4",
        "4, vector field C",
        "Lemma 2",
        "Lemma 3",
        "(6.7)",
        "(6.8)",
    ),
    *("Lemma 4", "Proposition 1", "(7.6)", "after Lemma 5", "Lemma 5, proof", "Lemma 6", "Lemma 7", "7.3"),
    "captions",
)


@pytest.mark.parametrize("row", MISPRINTS, ids=lambda row: row.where)
def test_the_numbers_refute_the_printed_form_and_bear_the_right_one(row):
    found = row.decide()
    assert math.isfinite(found.printed)
    assert found.right <= found.bound
    assert found.printed >= FACTOR * found.bound
    assert found.decides
    assert row.printed != row.right


def test_every_known_place_is_there():
    assert all(any(row.where.startswith(place) for row in MISPRINTS) for place in PLACES)
    assert len({row.where for row in MISPRINTS}) == len(MISPRINTS) == 23


def test_evidence_that_does_not_tell_the_forms_apart_decides_nothing():
    assert Evidence("", 1.0, 1e-9, 1e-3).decides
    assert not Evidence("", 1.0, 2e-3, 1e-3).decides
    assert not Evidence("", 0.05, 1e-9, 1e-3).decides
    assert not Evidence("", math.nan, 1e-9, 1e-3).decides
    assert not Evidence("", 1.0, math.nan, 1e-3).decides


def test_lemma_2_gives_the_known_numbers():
    printed, right, truth = lemma_2()
    assert (f"{printed:.4f}", f"{right:.4f}", f"{truth:.4f}") == ("1.0449", "0.6259", "0.6259")


@pytest.mark.parametrize(
    "disk", [ex.Disk.uniform(), ex.Disk.hoop(), ex.Disk(I1=0.5, I3=0.1)], ids=lambda d: f"{d.I3}"
)
def test_the_series_solve_chaplygins_equation(disk):
    series = Chaplygin.of(disk)
    r0, dr0 = (float(value) for value in series.recessive(1.0))
    X, Y, z = 0.7, -0.3, 0.95
    found = solve_ivp(
        lambda at, x: (x[1], series.c * x[0] / (1.0 - at * at)), (0.0, z), (X, Y), "DOP853", rtol=1e-13, atol=1e-14
    )
    x, y, _ = series.near_flat(X / r0, X * dr0 + Y * r0, 1.0 - z)
    assert found.y[:, -1] == pytest.approx([float(x), float(y)], rel=1e-11)


def test_the_slope_of_the_potential_is_its_derivative():
    series, S, h = Chaplygin.of(ex.Disk.uniform()), 0.2, 1e-4
    x, y, _ = series.near_flat(0.8, 0.3, S)
    W = [float(series.near_flat(0.8, 0.3, S + k * h)[2]) for k in (-2, -1, 1, 2)]
    derivative = -np.dot([1.0, -8.0, 8.0, -1.0], W) / (12.0 * h)
    assert float(series.slope_of_W(x, y, S)) == pytest.approx(derivative, rel=1e-10)


def test_the_page_lists_every_misprint_with_both_numbers_and_is_the_same_each_time():
    page = misprints_page()
    rows = [line for line in page.splitlines() if line.startswith("| ")][1:]
    assert len(rows) == len(MISPRINTS)
    for line, row in zip(rows, MISPRINTS, strict=True):
        cells = line.replace("\\|", "¦").strip("| ").split(" | ")
        assert len(cells) == 6
        assert cells[0] == row.where
        off, right_off = float(cells[4]), float(cells[5].removeprefix("< "))
        assert off > 10.0 * right_off
    assert misprints_page() == page
