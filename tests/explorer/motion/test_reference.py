"""Answers by quadrature and their error estimates against some 600 motions of every kind in 40 digits.

`tests/tools/make_motions.py` makes them. Errors are of angles (rad), and relative of times and tilts. Beyond
the accuracy asked 64 units of rounding are allowed for each radian of chi and psi.
"""

from typing import NamedTuple

import numpy as np
import pytest
from reference.motions import FALLS, MOTIONS, PASSAGES, of_one_body, states_of

import explorer as ex

ACCURACIES = (1e-11, 1e-9, 1e-6, 1e-3)


class Compared(NamedTuple):
    """Rows of motions and, NaN where there is no answer, their errors, their estimates and what is allowed."""

    rows: np.ndarray
    error: np.ndarray
    estimate: np.ndarray
    allowed: np.ndarray


def compared(answer, chosen, accuracy):
    """Of chosen motions: `answer` gives errors, the estimate and the angles of those of one body."""
    parts = []
    for rows in of_one_body(chosen):
        motions = MOTIONS[rows]
        disk = ex.Disk(I1=motions["I1"][0], I3=motions["I3"][0])
        errors, estimate, angles = answer(disk, motions, accuracy)
        known = np.isfinite(estimate)
        error = np.where(known, np.nanmax(np.abs([*errors, np.zeros(rows.size)]), axis=0), np.nan)
        allowed = np.fmax(accuracy, 64.0 * 2.2e-16 * np.nansum(np.abs(angles), axis=0))
        parts.append((rows, error, estimate, np.where(known, allowed, np.nan)))
    return Compared(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def whole(motions, name):
    """What both stretches of motions add up to; there is one where the vertical is not crossed."""
    return np.nansum([motions[f"{name}_0"], motions[f"{name}_1"]], axis=0)


def passages(disk, motions, accuracy):
    start = motions["sigma3_bar"], motions["eta_hat"], abs(motions["phidot"]), motions["face"]
    found = ex.passages(disk, *start, accuracy=accuracy)
    chi, psi, fall = motions["chi_0"], motions["psi_0"], motions["fall_angle"]
    angles = found.delta_chi - chi, found.delta_psi - psi, found.fall_angle - fall, found.race_angle - (chi - fall)
    shares = found.duration / motions["duration_0"] - 1.0, found.theta_min / motions["theta_min_0"] - 1.0
    return [*angles, *shares], np.where(found.ok, found.error_estimate, np.nan), [chi, psi]


def falls(disk, motions, accuracy):
    found = ex.passages(disk, motions["sigma3_bar"], 0.0, abs(motions["phidot"]), accuracy=accuracy)
    late = 2.0 * found.fall_time / motions["duration_0"] - 1.0
    fell = found.status == ex.Status.FALLS
    return [late, found.fall_angle - motions["chi_0"]], np.where(fell, found.error_estimate, np.nan), [fell]


def periods(disk, motions, accuracy):
    found = ex.periods(states_of(disk, motions), accuracy=accuracy)
    chi, psi = whole(motions, "chi"), whole(motions, "psi")
    theta_min = np.fmin(motions["theta_min_0"], motions["theta_min_1"])
    shares = found.period / whole(motions, "duration") - 1.0, found.theta_min / theta_min - 1.0
    assert (found.crosses == np.isfinite(motions["chi_1"]))[found.ok].all()
    return (
        [found.chi - chi, found.psi - psi, *shares],
        np.where(found.ok, found.error_estimate, np.nan),
        [chi, psi],
    )


def bounces(disk, motions, accuracy, number=0):
    """The first ones, or the second ones, which are the same again where the vertical is not crossed."""
    again = (number == 1) & np.isfinite(motions["chi_1"])
    chi, psi, theta_min, duration = (
        np.where(again, motions[f"{name}_1"], motions[f"{name}_0"])
        for name in ("chi", "psi", "theta_min", "duration")
    )
    found, fall = ex.bounces(states_of(disk, motions), 2, accuracy=accuracy), motions["fall_angle"]
    column = {name: values[:, number] for name, values in found.columns.items() if values.ndim == 2}
    angles = [column[name] for name in ("delta_chi", "delta_psi", "fall_angle", "race_angle")]
    late = column["time"] - motions["time"] if number == 0 else np.zeros(again.size)
    longest = np.fmax(motions["time"], whole(motions, "duration"))
    shares = column["duration"] / duration - 1.0, column["theta_min"] / theta_min - 1.0, late / longest
    ok = column["status"] == ex.Status.OK
    assert (column["face"] == np.where(again, -1, 1) * motions["first_face"])[ok].all()
    errors = *np.subtract(angles, [chi, psi, fall, chi - fall]), *shares
    return errors, np.where(ok, column["error_estimate"], np.nan), [chi, psi]


# How many motions have no answer, by accuracy. Passages: two beside a crest, where rounding of E - V leaves ten
# digits of one and three of the other. Falls: of bodies with I3/I1 = 1e-6, which spin by thousands of radians.
# Periods and bounces: the one with three digits, four that are on F of the other face to rounding, and one of 80 s
# beside the vertical. Bounces: narrow wobbles, twenty of them of fast spins, since rounding of V' at the state
# leaves open when they are flattest; motions that turn by thousands of radians, whose times rounding leaves open;
# and those near flat where it does so with E - V_0 and the fall angle.
REFUSED = {
    passages: (2, 1, 1, 0),
    falls: (2, 0, 0, 0),
    periods: (6, 6, 5, 5),
    bounces: (82, 43, 17, 5),
}
CAUTION = 1e3  # what estimates may be in the median, times the error


@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize("answer", REFUSED, ids=lambda answer: answer.__name__)
def test_answers_are_as_right_as_they_say(answer, accuracy):
    """Within the accuracy and three times the estimate, which is not many times too large."""
    chosen = {passages: PASSAGES, falls: FALLS}.get(answer, ~FALLS)
    found = compared(answer, chosen, accuracy)
    known = np.isfinite(found.estimate)
    assert (~known).sum() <= REFUSED[answer][ACCURACIES.index(accuracy)]
    rows, error, estimate, allowed = (column[known] for column in found)
    assert (error <= allowed).all(), rows[error > allowed]
    assert (estimate <= allowed).all(), rows[estimate > allowed]
    assert (error <= 3.0 * estimate).all(), rows[error > 3.0 * estimate]
    assert np.median(estimate / np.fmax(error, 1e-16)) <= CAUTION


def test_limit_motions_have_the_periods_of_falls_and_rises():
    """A fall to flat, the jump there, the way to the other face, and back."""
    for rows in of_one_body(FALLS):
        for motions in (MOTIONS[[row]] for row in rows):
            disk = ex.Disk(I1=motions["I1"][0], I3=motions["I3"][0])
            limit = ex.limit_motion(states_of(disk, motions))
            assert limit.face == motions["face"]
            assert limit.period == pytest.approx(whole(motions, "duration")[0], rel=1e-11)
            assert limit.chi_per_period == pytest.approx(whole(motions, "chi")[0] + disk.race_limit, abs=3e-9)


@pytest.mark.parametrize(("m", "r", "g"), [(0.0057, 0.0121, 9.81), (8e12, 1000.0, 9.81), (1.0, 0.3, 1.62)])
def test_passages_are_the_same_in_any_units(m, r, g):
    """A coin, a disk of 2 km, one on the Moon."""
    usual = PASSAGES & (MOTIONS["kind"] == "passage")
    motions = MOTIONS[usual & (MOTIONS["I1"] == 0.25) & (MOTIONS["I3"] == 0.5)]
    disk, rate = ex.Disk.uniform(m=m, r=r, g=g), np.sqrt(g / r)
    start = (rate * column for column in (motions["sigma3_bar"], motions["eta_hat"], abs(motions["phidot"])))
    found = ex.passages(disk, *start, motions["face"], accuracy=1e-9)
    assert found.ok.all()
    np.testing.assert_allclose(found.delta_chi, motions["chi_0"], rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(found.duration * rate, motions["duration_0"], rtol=1e-9)
