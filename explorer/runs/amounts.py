"""Sizes and times as people read them: 83.6 TB, 11 days."""

_SIZES = ("B", "kB", "MB", "GB", "TB", "PB")
# A unit of time is used above so many seconds.
_TIMES = ((2 * 86400.0, 86400.0, "days"), (7200.0, 3600.0, "h"), (120.0, 60.0, "min"))


def size(count: float) -> str:
    """A number of bytes to three digits."""
    unit = 0
    while count >= 999.5 and unit < len(_SIZES) - 1:
        count, unit = count / 1000.0, unit + 1
    return f"{count:.3g} {_SIZES[unit]}"


def duration(seconds: float) -> str:
    """A time in days, hours, minutes or seconds."""
    for least, unit, name in _TIMES:
        if seconds >= least:
            return f"{seconds / unit:,.0f} {name}"
    return f"{seconds:.1f} s"
