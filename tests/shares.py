"""The accuracy paid for: samples with true answers, and their errors as shares of the accuracy asked."""

from typing import NamedTuple

import numpy as np
from reference_samples import IN_TIME, RACING, ReferenceMotions, ReferencePassages

import explorer as ex
from explorer.motion.passage_starts import starts_at_vertical

ACCURACIES = 10.0 ** -np.arange(2, 11)
INTEGRATORS = ("rk4", "rk8", "dopri5", "dop853")
# Ends of motions (natural units), some within the first passage, some after the second.
ENDS = (1.25, 2.5, 3.75, 5.0)
_PASSAGE = 2.0  # `simulate` is asked for an accuracy of each so much time


class Share(NamedTuple):
    """What became of samples at one accuracy.

    p99: the 99th percentile of the error over the accuracy. over_estimate: the largest error over its estimate.
    answered: the share of samples with an answer. wrong_way: samples on the other side of F.
    """

    p99: float
    over_estimate: float
    answered: float
    wrong_way: int


def share_of(accuracy, errors, estimates, answered, wrong_way, passages=1.0):
    """The Share of samples (n) whose truth is known. passages: how many times the accuracy each may err."""
    over = (errors / estimates)[answered]
    p99 = np.percentile((errors / passages)[answered], 99) / accuracy
    return Share(float(p99), float(over.max()), float(answered.mean()), int((wrong_way & answered).sum()))


def assert_paid_for(measured, method):
    """At every accuracy p99 is within it, estimates hold, and all are answered.

    Of integrators it is not below a hundredth of the accuracy either: digits cost them steps.
    """
    for accuracy in ACCURACIES:
        got = measured.share(method, accuracy)
        assert got.p99 <= 1.0, (accuracy, got)
        assert got.p99 >= 0.01 or method == "quadrature", (accuracy, got)
        assert got.over_estimate <= 10.0, (accuracy, got)
        assert got.answered == 1.0, (accuracy, got)
        assert got.wrong_way == 0, (accuracy, got)


def across(disk, n, seed):
    """sigma3_bar, eta_hat, phidot and face of starts at the vertical at distances from F from 1e-8 to 1."""
    rng, unit = np.random.default_rng(seed), disk.rate_unit
    eta_hat = 10.0 ** rng.uniform(-8.0, 0.0, n) * rng.choice([-1.0, 1.0], n)
    bar, speed, face = rng.uniform(-2.0, 2.0, n), rng.uniform(0.3, 2.0, n), rng.choice([-1.0, 1.0], n)
    return bar * unit, eta_hat * unit, speed * unit, face


def anywhere(disk, count, seed):
    """States all over the phase space, most of which do not cross the vertical."""
    random, unit = np.random.default_rng(seed), disk.rate_unit
    rates = unit * random.uniform(-1.0, 1.0, (3, count))
    return ex.phi_to_states(disk, random.uniform(-1.4, 1.4, count), *rates)


class Passages:
    """Passages as `ex.passages` finds them, beside those by adaptive rules, which share no table with them."""

    def __init__(self, disk, n, seed):
        self.disk, self.given = disk, across(disk, n, seed)
        self.samples = ReferencePassages(disk, starts_at_vertical(disk, *self.given))

    def share(self, method, accuracy):
        found = ex.passages(self.disk, *self.given, method=method, accuracy=accuracy)
        tried, known = self.samples.compare((found, None)), self.samples.exact.ok
        estimates = found.error_estimate + self.samples.exact.error_estimate
        columns = (tried.errors, estimates, found.ok, tried.wrong_way)
        return share_of(accuracy, *(column[known] for column in columns))


class Motions:
    """Motions as `ex.simulate` follows them to given times, outside of races, beside finest steps."""

    at_once, shares = 10_000, np.ones(1)  # how many together, and their times as shares of the end

    def __init__(self, disk, n, seed):
        bar, eta_hat, speed, face = across(disk, n, seed)
        states = ex.constants_to_states(disk, bar, eta_hat, speed, face)
        ends = np.repeat(ENDS, -(-n // (len(ENDS) * self.at_once)))
        parts = np.array_split(np.arange(n), ends.size)
        times = [end * disk.time_unit * self.shares for end in ends]
        self.samples = [ReferenceMotions(states.at(rows), t) for rows, t in zip(parts, times, strict=True)]
        self.passages = np.repeat(np.maximum(1.0, ends / _PASSAGE), [rows.size for rows in parts])
        slow = [(abs(each.exact.phi) < 0.5 * np.pi - RACING).any(axis=1) for each in self.samples]
        self.known = np.concatenate(
            [each.exact.ok & known for each, known in zip(self.samples, slow, strict=True)]
        )

    def share(self, method, accuracy):
        how = {"observables": IN_TIME, "method": method, "accuracy": accuracy}
        found = [ex.simulate(each.states, t_eval=each.times, **how) for each in self.samples]
        tried = [each.compare(made) for each, made in zip(self.samples, found, strict=True)]
        errors, wrong_way = (np.concatenate([getattr(t, name) for t in tried]) for name in ("errors", "wrong_way"))
        estimates, ok = (np.concatenate([getattr(m, name) for m in found]) for name in ("error_estimate", "ok"))
        columns = (errors, estimates, ok, wrong_way, self.passages)
        return share_of(accuracy, *(column[self.known] for column in columns))


class Ways(Motions):
    """The same at times all along the way: the largest error of these."""

    at_once, shares = 20, np.arange(1, 17) / 16
