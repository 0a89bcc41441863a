"""Every motion as arcs between turning points, the vertical, states and flat.

`potential` gives the change of V from an end, `turning_points` where a motion turns, `rules` the integrals over
arcs between such places, and `nutation` those over wells too narrow for them. `explorer.motion.orbits` and
`explorer.motion.arcs` call them in this order: they cut arcs where motions are slow, name their kinds, and add up.
`pieces` gives a whole rise as series, and `motions` the motion at any time from these; `explorer.motion.rises`
says from where points of a rise are counted.
"""
