"""The interactive page: the disk rolls in three dimensions, on both sides of F, in any browser."""
