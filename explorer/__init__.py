"""nearflat: a Monte Carlo explorer of the rolling disk's phase space.

    import explorer as ex
    disk = ex.Disk.uniform()
    states = ex.phi_to_states(disk, phi=0.0, phidot=1.0, sigma3=1.0, sigma4=0.7)
    ex.constants(states)
    ex.run("race-angles", disk=disk, samples=100_000)

Names are loaded on first use, so that importing this package is cheap.
"""

from typing import TYPE_CHECKING

from explorer.lazy import make_lazy

if TYPE_CHECKING:
    from explorer.commands.calls import plan as plan
    from explorer.commands.calls import run as run
    from explorer.commands.calls import trade as trade
    from explorer.commands.cite import cite as cite
    from explorer.errors import CoarseTimesWarning as CoarseTimesWarning
    from explorer.errors import InputError as InputError
    from explorer.errors import Interrupted as Interrupted
    from explorer.errors import RunError as RunError
    from explorer.measure.falling_constant import falling_constant as falling_constant
    from explorer.measure.invariance import flow_stretch as flow_stretch
    from explorer.measure.invariance import push_forward as push_forward
    from explorer.measure.probability import Probability as Probability
    from explorer.measure.probability import probability as probability
    from explorer.measure.races import race_law as race_law
    from explorer.measure.slices import slice_map as slice_map
    from explorer.motion.both_sides import both_sides as both_sides
    from explorer.motion.bounces import bounces as bounces
    from explorer.motion.compare import Comparison as Comparison
    from explorer.motion.compare import compare as compare
    from explorer.motion.forces import passage_forces as passage_forces
    from explorer.motion.limit_motions import limit_motion as limit_motion
    from explorer.motion.passages import passages as passages
    from explorer.motion.periods import periods as periods
    from explorer.motion.rocking import rocking as rocking
    from explorer.motion.scan import scan as scan
    from explorer.motion.trajectories import simulate as simulate
    from explorer.motion.wander import resonance as resonance
    from explorer.motion.wander import wander as wander
    from explorer.motion.wander import wander_path as wander_path
    from explorer.phase.bifurcation import bifurcation as bifurcation
    from explorer.phase.constants import constants as constants
    from explorer.phase.coordinates import constants_to_states as constants_to_states
    from explorer.phase.coordinates import coordinates_to_states as coordinates_to_states
    from explorer.phase.coordinates import rates_to_states as rates_to_states
    from explorer.phase.disk import Disk as Disk
    from explorer.phase.falling_set import falls as falls
    from explorer.phase.potential import potential as potential
    from explorer.phase.results import Status as Status
    from explorer.phase.states import States as States
    from explorer.phase.states import StateWarning as StateWarning
    from explorer.phase.states import phi_to_states as phi_to_states
    from explorer.phase.states import theta_to_states as theta_to_states
    from explorer.phase.steady import circular_rolling as circular_rolling
    from explorer.phase.steady import steady_motions as steady_motions
    from explorer.pictures.calls import picture as picture
    from explorer.pictures.calls import pictures as pictures
    from explorer.runs.merge import merge as merge
    from explorer.runs.run import Run as Run
    from explorer.runs.run import open as open
    from explorer.scenes.scene import register as register
    from explorer.version import __version__ as __version__
    from explorer.view.page import view as view

__all__ = make_lazy(__name__)
