"""Section 2 of the paper holds, and every row fails once something in it is damaged."""

import numpy as np
from paper_rows import Statements, scaled, upwards

from explorer.paper import eight_dimensions as plain
from explorer.paper import section_2

NUMBERS = range(1, 9)


def crooked(original):
    """A force that knows a direction in the body."""
    return lambda disk, u, omega: original(disk, u, omega) + np.array([1e-6, 0.0, 0.0])


def printed_angles(original):
    """Eq. (2.32) as printed: phi + pi/2 where pi/2 - phi is right."""
    return lambda chi, tilt, psi: original(chi, np.pi - tilt, psi)


def printed_contact(_original):
    """Eq. (2.35) as printed."""
    return lambda disk, v, a: disk.r * v[:, 2:] * v / np.sqrt(1.0 - v[:, 2:] ** 2) + a


DAMAGES = [
    (1, section_2, "inertia_tensor", scaled(1.0 + 1e-6)),
    (2, plain, "rim_velocity", scaled(1.0 + 1e-6)),
    (3, plain, "angular_acceleration", upwards),
    (4, section_2, "sigma_energy", scaled(1.0 + 1e-6)),
    (5, plain, "angular_acceleration", crooked),
    (6, section_2, "space_velocity", scaled(1.0 + 1e-6)),
    (7, section_2, "euler_rotation", printed_angles),
    (8, section_2, "contact_from_normal", printed_contact),
]


class TestStatements(Statements):
    """Those of NUMBERS, each with its damage."""
