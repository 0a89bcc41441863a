"""Where the disk is at one moment, as a body in space."""

import math
from dataclasses import dataclass

import numpy as np

from explorer.phase.states import Array


@dataclass(frozen=True)
class Pose:
    """The disk at one moment, eqs (2.33) to (2.35).

    phi, chi, psi: tilt, contact angle and angle of the body (rad). centre: of mass (3). r: radius of the rim.
    """

    phi: float
    chi: float
    psi: float
    centre: Array
    r: float

    @property
    def normal(self) -> Array:
        """The axis of the body, (3): it points up where phi > 0."""
        q, z = math.cos(self.phi), math.sin(self.phi)
        return np.array([q * math.cos(self.chi), q * math.sin(self.chi), z])

    @property
    def contact(self) -> Array:
        """The point of the rim that touches the table, (3)."""
        return self.place(0.0)

    def directions(self, angles: Array) -> Array:
        """Unit vectors (n, 3) from the centre to places on the rim, at angles (rad) from the contact point."""
        q, z = math.cos(self.phi), math.sin(self.phi)
        c, s = math.cos(self.chi), math.sin(self.chi)
        down, along = np.array([z * c, z * s, -q]), np.array([-s, c, 0.0])
        return np.asarray(np.cos(angles)[:, None] * down + np.sin(angles)[:, None] * along)

    def rim(self, angles: Array, share: float = 1.0) -> Array:
        """Points of the disk (n, 3) at `share` of its radius, at angles (rad) from the contact point."""
        return np.asarray(self.centre + share * self.r * self.directions(angles))

    def place(self, angle: float, share: float = 1.0) -> Array:
        """One such point, (3)."""
        return np.asarray(self.rim(np.array([angle]), share)[0])

    @property
    def mark_angle(self) -> float:
        """Where a mark of the body is that is on top where psi = 0 at the vertical (rad from the contact)."""
        return math.pi - self.psi

    @property
    def mark(self) -> Array:
        """This place on the rim, (3)."""
        return self.place(self.mark_angle)
