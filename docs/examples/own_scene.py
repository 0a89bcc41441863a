"""A scene of one's own: how long is a period of motions that start at the vertical?

It runs from Python, as below, and by: nearflat run own_scene.py:Periods --speed 1
"""

import explorer as ex
from explorer.scenes import Column, Counts, Distribution, LogHistogram, SampledScene, number_from, option


class PeriodCounts(Counts):
    """What is counted of all samples: fields that add up, from chunk to chunk and from run to run."""

    total: float
    period: LogHistogram


class Periods(SampledScene):
    """How long is a period? Of motions that start at the vertical with speeds below a limit."""

    speed: float = option(number_from(0.1), "largest speed at the vertical", default=2.0)
    tally = PeriodCounts
    columns = {"phidot": Column("Speed at the vertical.", "rad/time"), "period": Column("Period.", "time")}  # noqa: RUF012

    def draw(self, random, count):  # initial states, 65,536 from each random stream
        box = {"phidot": (0.1, self.speed), "sigma3": (-1.0, 1.0), "sigma4": (-1.0, 1.0)}
        return Distribution.box(self.disk, box).draw(random, count)

    def observe(self, drawn):  # what is found of some of them
        found = ex.periods(ex.phi_to_states(self.disk, **drawn), accuracy=self.accuracy)
        return {"phidot": drawn["phidot"], "period": found.period, "status": found.status}

    def count(self, tally, table):  # what is added to the counts
        good = table["period"][table["status"] == 0]
        tally.total += float(good.sum())
        tally.period.count(good)

    def summarise(self, tally):  # the numbers of the run
        known = tally.period.total
        mean, median = tally.total / known, tally.period.quantile(0.5)
        return {**super().summarise(tally), "known": known, "mean": mean, "median": median}
