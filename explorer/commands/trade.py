"""`nearflat trade`: speed against accuracy, measured on passages near F."""

import argparse
import platform
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, ClassVar

from explorer.commands import Answer
from explorer.errors import InputError, note
from explorer.measure.sampling import Range
from explorer.motion.passage_starts import starts_at_vertical
from explorer.motion.passages import Passages, reference_passages
from explorer.motion.work_precision import Trade, measure
from explorer.paths import own_folder
from explorer.phase.coordinates import coordinates_to_states
from explorer.phase.disk import SYNTAX, Disk
from explorer.phase.results import stacked
from explorer.phase.states import States
from explorer.scenes.options import BOX, DISK, RANGE, TRUTH, Options, option, seeded, whole_from
from explorer.scenes.race_angles import RaceAngles, start_of
from explorer.scenes.starts import BOX_NEAR_F, ETA_HAT, eta_hat_span

_OUT = Path("results/trade")
_ABOUT = """The passages are computed by `compare` at each accuracy. Times are on the clock, for one core, without
compile time, the shortest of four rounds in which the methods take turns. Compare them only within this
page. *Unresolved* is the share of passages whose side of the falling set F is unknown, *refused* the share
without an answer for another reason, and *wrong_way* counts passages that came out on the other side of F.
*on_front* is True if no other integrator is both as fast and as accurate."""


class TradeOptions(Options):
    """Passages that start near the falling set at the vertical."""

    name: ClassVar[str] = "trade"

    disk: Disk = option(DISK, f"disk: {SYNTAX}", default=Disk.uniform())
    # The time of fewer is mostly that of the call.
    samples: int = option(whole_from(256), "number of passages", default=4096)
    seed: int = seeded()
    box: Any = option(BOX, BOX_NEAR_F, words="phidot=0.5:2,sigma3=-2:2 in natural units")
    eta_hat: Range = option(
        RANGE,
        ETA_HAT,
        words="1e-8:1 natural units",
        follows=lambda self, given: eta_hat_span(self.disk, given, (1e-8, 1.0)),
    )
    progress: bool = option(TRUTH._replace(metavar=None), "False prints nothing", default=True)

    @property
    def scene(self) -> RaceAngles:
        """The scene whose samples they are."""
        said = {name: getattr(self, name) for name in ("disk", "samples", "seed", "box", "eta_hat")}
        return RaceAngles(start="near", **said)

    def drawn(self) -> tuple[States, Passages]:
        """The states that the scene draws, and their true passages, where these are ok."""
        scene = self.scene
        samples = stacked([block for index in range(scene.chunks) for block in scene.blocks(index)])
        exact = reference_passages(self.disk, starts_at_vertical(self.disk, *start_of(samples)))
        if not exact.ok.any():
            raise InputError(
                "box: none of these passages is known; give phidot above 0 and below 1e75 natural units"
            )
        return coordinates_to_states(self.disk, degrees=False, **samples), exact


def measured(chosen: TradeOptions) -> Trade:
    """What `ex.trade` returns. Raises InputError."""
    return measure(*chosen.drawn(), lambda text: note(text, not chosen.progress))


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat trade`."""
    TradeOptions.add_to(command)
    command.add_argument("--out", metavar="DIR", type=Path, default=_OUT, help=f"folder (default {_OUT})")


def call(options: argparse.Namespace) -> Answer:
    """Measure, and write README.md and trade.png."""
    from matplotlib.figure import Figure

    from explorer.commands.pages import write_page
    from explorer.pictures.register import save
    from explorer.pictures.style import SIZE
    from explorer.pictures.work_precision import work_precision

    asked = TradeOptions.of({**TradeOptions.said(options), "progress": not options.quiet})
    out, found = own_folder("out", options.out), measured(asked)
    figure = Figure(figsize=SIZE, layout="constrained")
    work_precision(found, ax=figure.subplots())
    save(figure, picture := out / "trade.png")
    parts = [("Error and time of all methods", [_ABOUT], [picture]), ("Passages", str(found).split("\n"), [])]
    made_by = f"`{options.command_line}` on {platform.machine()}, {platform.system()}."
    write_page(out, f"Speed against accuracy, {asked.disk.name} disk", made_by, parts)
    record = {"scene": asked.scene.options, "known": found.known, "rows": [asdict(row) for row in found.rows]}
    return Answer(record, f"{found}\n\nTable and picture are in {out}.")
