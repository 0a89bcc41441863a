"""Questions about many states: one file each, which declares its own options."""
