"""Motions that stay in a rosette, and one that walks away at a resonance."""

import numpy as np

import explorer as ex
from explorer.motion.wander import resonance, wander_path


def start(disk, sigma3_bar, eta_hat, phidot=1.0):
    """Starts at the vertical, in natural units."""
    unit = disk.rate_unit
    return ex.constants_to_states(disk, np.multiply(sigma3_bar, unit), np.multiply(eta_hat, unit), phidot * unit)


def resonant_and_paths(disk):
    """Where chi turns twice a period, with its start; and paths of a generic motion and of this one."""
    found = resonance(disk, 0.01, 1.0, 2, (0.15, 0.3))
    return found, {"generic": wander_path(start(disk, 1.0, 0.01), 30), "resonance": wander_path(found[1], 8)}
