"""Which version of a package is installed."""

from functools import cache


@cache
def installed_version(name: str = "nearflat") -> str | None:
    """The version of an installed package; None where it is not installed, such as a folder on the path."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(name)
    except PackageNotFoundError:
        return None


__version__ = installed_version() or "0+unknown"
