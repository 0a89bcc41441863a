"""Sections 2 to 5 of the paper: every row passes, and every row fails once something in it is damaged."""

import numpy as np
import pytest

from explorer.paper import chaplygin, mechanics, reduction
from explorer.paper import eight_dimensions as plain
from explorer.paper.statement import STATEMENTS

ROWS = range(1, 27)


@pytest.mark.parametrize("number", ROWS)
def test_every_finding_of_the_row_passes(number):
    findings = list(STATEMENTS[number].check())
    assert findings
    assert [(f.computed, f.error, f.tolerance) for f in findings if not f.passed] == []


def test_the_rows_are_all_there_with_names_of_their_own():
    rows = [STATEMENTS[number] for number in ROWS]
    assert len({row.name for row in rows}) == len(rows)
    assert all((row.name == row.name.upper() and "(" in row.text) or "." in row.text for row in rows)


def slightly(function, factor=1.0 + 1e-6):
    """The function with what it returns scaled."""

    def damaged(*arguments, **named):
        found = function(*arguments, **named)
        return tuple(factor * part for part in found) if isinstance(found, tuple) else factor * found

    return damaged


def printed_acceleration(disk, u, omega):
    """Eq. (2.12) as printed: gravity pulls up."""
    right = plain_acceleration(disk, u, omega)
    s = plain.rim_point(disk, u)
    matrix = np.diag([disk.I1, disk.I1, disk.I3]) + disk.m * disk.r**2 * np.eye(3) - disk.m * np.outer(s, s)
    return right - np.linalg.solve(matrix, 2.0 * disk.m * disk.g * np.cross(s, u))


def crooked_acceleration(disk, u, omega):
    """A force that knows a direction in the body."""
    return plain_acceleration(disk, u, omega) + np.array([1e-6, 0.0, 0.0])


def printed_angles(chi, tilt, psi):
    """Eq. (2.32) as printed: phi + pi/2 where pi/2 - phi is right."""
    return euler_rotation(chi, np.pi - tilt, psi)


def printed_contact(disk, v, a):
    """Eq. (2.35) as printed."""
    return disk.r * v[:, 2:] * v / np.sqrt(1.0 - v[:, 2:] ** 2) + a


def printed_lemma(c, X, Y, z, constant=0.0):
    """Lemma 2 with the printed integral of u."""
    return lemma_2(c, X, Y, z, constant=0.0)


def real_root(c):
    """(5.11), (5.12) with |1 - 4c|, as a square root of real numbers might give."""
    value = np.asarray(c, dtype=complex)
    return at_vertical(np.where(value.real > 0.25, 0.5 - value, value))


plain_acceleration, euler_rotation = plain.angular_acceleration, mechanics.euler_rotation
lemma_2, at_vertical, inverse_square = chaplygin.lemma_2, chaplygin.at_vertical, chaplygin.inverse_square
DAMAGE = {
    1: (mechanics, "inertia_tensor", slightly(mechanics.inertia_tensor)),
    2: (plain, "rim_velocity", slightly(plain.rim_velocity)),
    3: (plain, "angular_acceleration", printed_acceleration),
    4: (mechanics, "sigma_energy", slightly(mechanics.sigma_energy)),
    5: (plain, "angular_acceleration", crooked_acceleration),
    6: (mechanics, "space_velocity", slightly(mechanics.space_velocity)),
    7: (mechanics, "euler_rotation", printed_angles),
    8: (mechanics, "contact_from_normal", printed_contact),
    9: (reduction, "_chaplygin_rates", slightly(reduction._chaplygin_rates)),
    10: (reduction, "_chaplygin_rates", slightly(reduction._chaplygin_rates)),
    11: (reduction, "amended", slightly(reduction.amended)),
    12: (reduction.Swing, "period", slightly(reduction.Swing.period)),
    13: (reduction.Swing, "period", slightly(reduction.Swing.period)),
    14: (reduction, "_growth", slightly(reduction._growth, 1.002)),
    15: (plain, "angular_acceleration", slightly(plain.angular_acceleration)),
    16: (reduction, "parameters", slightly(reduction.parameters)),
    17: (reduction, "scaled", slightly(reduction.scaled)),
    18: (reduction, "scaled_slope", slightly(reduction.scaled_slope)),
    19: (chaplygin, "coefficients", lambda c, terms: coefficients(1.01 * c, terms)),
    20: (chaplygin, "at_vertical", slightly(at_vertical)),
    21: (chaplygin, "inverse_square", lambda c, terms: inverse_square(2 * c, terms)),
    22: (chaplygin, "lemma_2", printed_lemma),
    23: (chaplygin, "recessive", lambda c, z, terms=120: recessive(c * (1.0 + 1e-6), z, terms)),
    24: (chaplygin, "at_vertical", slightly(at_vertical)),
    25: (chaplygin, "at_vertical", lambda c: at_vertical(np.asarray(c) + 1e-9)),
    26: (chaplygin, "at_vertical", real_root),
}
coefficients, recessive = chaplygin.coefficients, chaplygin.recessive


@pytest.mark.parametrize("number", ROWS)
def test_the_row_fails_when_damaged(number, monkeypatch):
    monkeypatch.setattr(*DAMAGE[number])
    assert not all(finding.passed for finding in STATEMENTS[number].check())
