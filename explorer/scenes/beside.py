"""Starts beside F: at the vertical, at a given distance eta_hat from the line of either face.

Shared by the scenes that look along F. The flow preserves the measure, so near F a draw of
(phidot, sigma3, eta_hat) at the vertical stands for draws anywhere along the motion.
"""

from collections.abc import Mapping
from dataclasses import replace

from explorer.errors import InputError
from explorer.measure.sampling import Box, Range, Stream, signs
from explorer.phase.arguments import read_range
from explorer.phase.disk import Disk
from explorer.phase.states import Array
from explorer.scenes import options
from explorer.scenes.options import Option

# In natural units: where doubles still have all their digits, and where "beside F" loses its meaning.
_BESIDE = (1e-305, 10.0)

BOX = replace(
    options.BOX,
    text="where motions start, at the vertical: speed towards flat and sigma3, in the units of the disk, as in "
    '"phidot=0.5:2,sigma3=-2:2"',
)


def eta_hat_option(default: str) -> Option:
    """The range of distances beside F, for both signs."""
    text = "distance |eta_hat| beside the falling set, both signs, in the units of the disk"
    return Option("--eta-hat", read_range, "LOW:HIGH", text, f"{default} natural units")


def default_box(disk: Disk) -> Box:
    """Speed towards flat 0.5 to 2, sigma3 -2 to 2, in natural units.

    Slower starts linger at the vertical, where the energy at which a motion compares with its
    limit is no longer close to its own.
    """
    unit = disk.rate_unit
    return Box((0.0, 0.0), (0.5 * unit, 2.0 * unit), (-2.0 * unit, 2.0 * unit), (0.0, 0.0))


def box_beside(disk: Disk, ranges: Mapping[str, Range]) -> Box:
    """The default box with other ranges. Raises InputError where these do not describe starts beside F."""
    if "sigma4" in ranges:
        raise InputError("--box sigma4: this scene sets sigma4 by --eta-hat; leave it out")
    box = replace(default_box(disk), **ranges)
    if box.phi != (0.0, 0.0):
        raise InputError("--box phi: this scene starts at the vertical; leave phi out or give phi=0")
    if box.phidot[0] < 0.0:
        raise InputError(
            f"--box phidot = {box.phidot[0]:g}:{box.phidot[1]:g}: this scene takes the speed towards flat, "
            "used for both faces; give 0 <= LOW"
        )
    return box


def describe_beside(box: Box) -> dict[str, list[float]]:
    """The ranges of a box that a scene beside F takes."""
    return {name: span for name, span in box.describe().items() if name in ("phidot", "sigma3")}


def check_eta_hat(span: Range, disk: Disk) -> None:
    """Raise InputError unless low <= high are magnitudes that lie beside F, in the units of the disk."""
    low, high = span
    nearest, furthest = (limit * disk.rate_unit for limit in _BESIDE)
    if not nearest <= low <= high <= furthest:
        raise InputError(
            f"--eta-hat {low:g}:{high:g}: give LOW:HIGH with {nearest:g} <= LOW <= HIGH <= {furthest:g}"
        )


def draw_beside(box: Box, random: Stream, count: int) -> dict[str, Array]:
    """`count` starts as `constants_to_states` takes them, but for eta_hat; both faces equally likely."""
    columns = box.draw(random, count)
    face = signs(random.random(count))
    return {"phidot": face * columns["phidot"], "sigma3_bar": columns["sigma3"], "face": face}
