"""Questions about many states: one file each. What a scene of one's own is made of can be imported from here."""

from typing import TYPE_CHECKING

from explorer.lazy import make_lazy

if TYPE_CHECKING:
    from explorer.measure.distributions import Distribution as Distribution
    from explorer.measure.tallies import ByName as ByName
    from explorer.measure.tallies import Histogram as Histogram
    from explorer.measure.tallies import LogHistogram as LogHistogram
    from explorer.phase.columns import Column as Column
    from explorer.scenes.options import NUMBER as NUMBER
    from explorer.scenes.options import RANGE as RANGE
    from explorer.scenes.options import TRUTH as TRUTH
    from explorer.scenes.options import number_from as number_from
    from explorer.scenes.options import option as option
    from explorer.scenes.options import whole_from as whole_from
    from explorer.scenes.options import word_of as word_of
    from explorer.scenes.scene import Counts as Counts
    from explorer.scenes.scene import SampledScene as SampledScene
    from explorer.scenes.scene import Scene as Scene

__all__ = make_lazy(__name__)
