"""Cases of the kernels: any doubles at all, as no caller of theirs would give them."""

import random
import struct

import numpy as np

from explorer import compiled
from explorer.phase.disk import Disk
from explorer.phase.gauss import packed_rules

from .judge import judge
from .values import EDGES

KERNELS = ("passages", "orbits", "bounces", "constants")


def double(rng):
    """Any bits, or a number at an end of what doubles hold, or a sensible one."""
    what = rng.random()
    if what < 0.2:
        return struct.unpack("d", rng.randbytes(8))[0]
    return rng.choice(EDGES) * rng.choice((1.0, -1.0)) if what < 0.6 else rng.uniform(-2.0, 2.0)


def call(name, disk, given):
    """Call a kernel with rows of numbers; AssertionError where a sample is ok and its numbers are not."""
    n = given.shape[1]
    status = np.zeros(n, np.int8)
    if name == "passages":
        out = np.full((8, n), np.nan)
        crossings = compiled.passages.Crossings(*given[:3])
        for kernel in (compiled.passages.rough_batch, compiled.passages.passage_batch):
            kernel(crossings, 1e-6, disk.tables, disk.natural, out, status)
        compiled.passages.wide_batch(crossings, 1e-6, disk.tables, disk.natural, out, status)
        compiled.passages.passage_by_rules_batch(crossings, 0.0, 1e-6, packed_rules(), disk.natural, out, status)
    elif name == "orbits":
        out = np.full((8, n), np.nan)
        compiled.orbits.orbit_batch(
            compiled.point.Orbits(*given[:5], given[0]), 1e-6, packed_rules(), disk.natural, out, status
        )
    elif name == "bounces":
        out = np.full((len(compiled.bounces.BounceRow._fields), n), np.nan)
        compiled.bounces.bounce_batch(
            compiled.point.Orbits(*given[:5], given[0]), 1e-6, packed_rules(), disk.natural, out, status
        )
    else:
        compiled.algebra.constants_batch(given[:5], disk.whole, disk.natural, np.empty((6, n)))
    assert set(status.tolist()) <= {int(code) for code in compiled.status.Status}


def run(cases, seed=0):
    """(kernel, arguments, verdict) of so many calls of kernels, a few samples each."""
    rng, disks = random.Random(seed), (Disk.uniform(), Disk.hoop(), Disk(I1=0.5, I3=0.3, name="thick"))
    for _ in range(cases):
        name, disk = rng.choice(KERNELS), rng.choice(disks)
        given = {
            "name": name,
            "disk": disk,
            "given": np.array([[double(rng) for _ in range(3)] for _ in range(5)]),
        }
        yield name, given, judge(call, given)
