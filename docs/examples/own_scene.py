"""A scene of one's own: how long is a period of motions that start at the vertical?"""

from dataclasses import dataclass
from functools import partial
from typing import Annotated, ClassVar

import explorer as ex
from explorer.errors import number
from explorer.measure.sampling import Box, chunk_stream
from explorer.scenes.base import SampledScene
from explorer.scenes.options import Option


@ex.register
@dataclass(frozen=True, kw_only=True)
class Periods(SampledScene):
    """How long is a period? Of motions that start at the vertical with speeds below a limit."""

    speed: float = 2.0
    name: ClassVar[str] = "periods"

    class Keywords(SampledScene.Keywords, total=False):
        speed: Annotated[float, Option("--speed", partial(number, low=0.1), "X", "largest speed at the vertical")]

    def compute(self, index):  # the samples of one chunk, from the random stream of that chunk
        box = Box((0.0, 0.0), (0.1, self.speed), (-1.0, 1.0), (-1.0, 1.0))
        states = ex.phi_to_states(self.disk, **box.draw(chunk_stream(self.seed, index), self.length(index)))
        found = ex.periods(states)
        return {"phidot": states.phidot, "period": found.period, "status": found.status}

    def tally(self, index, table):  # what a chunk adds to the summary: of all its samples, ready for JSON
        good = table["period"][table["status"] == 0]
        return {**super().tally(index, table), "known": good.size, "sum": float(good.sum())}

    def summarise(self, total):  # the numbers of the run, from the tallies of all chunks
        known = sum(tally["known"] for tally in total)
        return {"samples": self.samples, "known": known, "mean": sum(tally["sum"] for tally in total) / known}
