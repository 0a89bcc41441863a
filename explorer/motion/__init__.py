"""The way a motion goes on from its state: trajectories, passages, periods and limit motions."""
