"""Motion by Runge-Kutta steps: one step, one motion, many motions in lanes."""
