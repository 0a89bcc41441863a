"""`nearflat probability`: how probable it is to come nearly flat, for initial states with a distribution."""

import argparse

from explorer import compiled
from explorer.commands import Answer
from explorer.errors import note
from explorer.measure.importance_sampling import KERNELS
from explorer.measure.probability import probability, read_delta
from explorer.phase.disk import SYNTAX, Disk
from explorer.scenes.options import DISK, NUMBER, TRUTH, Options, Reader, option, plain, whole_from

_VALUE = Reader(lambda name, value: value, "VALUE", "object")


class Coordinates(Options):
    """Initial states: VALUE is a number, LOW:HIGH, or a distribution of SciPy such as norm:MEAN:DEVIATION."""

    tilt: str | None = option(_VALUE, "tilt from flat; with --precession and --spin")
    tilt_rate: str | None = option(_VALUE, "rate of the tilt (default 0)")
    precession: str | None = option(_VALUE, "rate at which the contact point turns about the vertical")
    spin: str | None = option(_VALUE, "angular velocity about the disk's own axis")
    phi: str | None = option(_VALUE, "angle to the vertical; give --phidot, --sigma3 and --sigma4 too")
    phidot: str | None = option(_VALUE, "rate of phi")
    sigma3: str | None = option(_VALUE, "sigma3 of eq. (2.14)")
    sigma4: str | None = option(_VALUE, "sigma4 of eq. (2.14)")
    energy: str | None = option(_VALUE, "energy, instead of phidot")
    sigma3_bar: str | None = option(_VALUE, "constant of motion, in the place of sigma3")
    sigma4_bar: str | None = option(_VALUE, "constant of motion, in the place of sigma4")
    eta_hat: str | None = option(_VALUE, "distance from the falling set, in the place of sigma4")
    face: str | None = option(_VALUE, "the face, 1 or -1, to which tilt or eta_hat refers (default 1)")
    degrees: bool = option(TRUTH, "angles and rates are in degrees", default=False)


class ProbabilityOptions(Coordinates):
    """The event, and how it is computed."""

    disk: Disk = option(DISK, f"disk: {SYNTAX}", default=Disk.uniform())
    event: tuple[str, float] = option(
        Reader(lambda name, value: ("theta_min", read_delta(name, value)), "theta_min:DELTA", "str"),
        "the event: the tilt becomes smaller than DELTA (rad)",
        default="theta_min:1e-3",
        words="theta_min:1e-3",
    )
    count: int = option(
        whole_from(1),
        "how many approaches to flat are followed; 2 are enough for the smallest tilt on each face",
        default=1,
    )
    samples: int = option(
        whole_from(10),
        "number of draws from the whole distribution; in addition, for each face an eighth as many, but at least "
        "4,096, are drawn close to the falling set",
        default=1_000_000,
    )
    accuracy: float = option(NUMBER._replace(metavar="TOL"), "relative accuracy of theta_min", default=1e-6)
    seed: int = option(whole_from(0), "seed of the random numbers", default=0)


add_arguments = ProbabilityOptions.add_to


def call(options: argparse.Namespace) -> Answer:
    """Say how probable it is."""
    asked = ProbabilityOptions.of(ProbabilityOptions.said(options))
    compiled.warmup(KERNELS, lambda text: note(text, options.quiet))
    given = vars(asked).copy()
    found = probability(given.pop("disk"), given.pop("event"), rng=given.pop("seed"), **given)
    record = {**vars(found), "law": found.law and found.law._asdict()}
    return Answer(plain(record), repr(found))
