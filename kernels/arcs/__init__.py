"""Every motion as arcs between turning points, the vertical, states and flat."""
