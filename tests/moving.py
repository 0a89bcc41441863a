"""Velocities of motions in time, from the observables that these have."""

import numpy as np


def _vector(plane, height):
    return np.stack([plane.real, plane.imag, height], axis=-1)


def velocity(motion):
    """Of the centre (..., nt, 3), eq. (2.33), units of the disk."""
    z, away = np.copysign(np.cos(motion.tilt), motion.phi), np.exp(1j * motion.chi)
    plane = (-motion.phidot * np.sin(motion.tilt) - 1j * motion.sigma4) * away
    return motion.states.disk.r * _vector(plane, -motion.phidot * z)


def nu(motion):
    """The angular velocity in space (..., nt, 3), eqs (2.27), (2.29)."""
    q, z, away = np.sin(motion.tilt), np.copysign(np.cos(motion.tilt), motion.phi), np.exp(1j * motion.chi)
    plane = (q * motion.sigma4 - z * motion.sigma3 / q - 1j * motion.phidot) * away
    return _vector(plane, motion.sigma3 + z * motion.sigma4)
