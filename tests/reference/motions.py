"""Motions as arrays with a field for each column: those of motions.csv, and those of motions_in_time.csv.

`make_motions` makes and describes the first file. The other one has 200 states and what their motions come to at
t = 1, 10 and 50, with chi and psi from 0 (m = r = g = 1): integrated in 128 bits, by Taylor series of order 34.
"""

from pathlib import Path

import numpy as np

import explorer as ex

MOTIONS, IN_TIME = (
    np.genfromtxt(Path(__file__).with_name(name), delimiter=",", names=True, dtype=None, encoding="utf-8")
    for name in ("motions.csv", "motions_in_time.csv")
)
TIMES = (1, 10, 50)  # of IN_TIME
BY_CONSTANTS = np.isfinite(MOTIONS["eta_hat"])
FALLS = MOTIONS["eta_hat"] == 0.0
PASSAGES = BY_CONSTANTS & (MOTIONS["phi"] == 0.0) & ~FALLS


def of_one_body(chosen):
    """The rows of chosen motions, those together that have the same body and are given in the same way."""
    kinds = np.stack([MOTIONS["I1"], MOTIONS["I3"], BY_CONSTANTS], axis=1)
    which = np.unique(kinds, axis=0, return_inverse=True)[1].ravel()
    return [np.flatnonzero(chosen & (which == kind)) for kind in np.unique(which[chosen])]


def states_of(disk, motions):
    """The states that motions of one body start from."""
    if np.isfinite(motions["eta_hat"][0]):
        names = ("phi", "phidot", "sigma3_bar", "eta_hat", "face")
        return ex.coordinates_to_states(disk, **{name: motions[name] for name in names})
    return ex.phi_to_states(disk, *(motions[name] for name in ("phi", "phidot", "sigma3", "sigma4")))
