"""Which version of a package is installed."""

from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    __version__: str


@cache
def installed_version(name: str = "nearflat") -> str | None:
    """The version of an installed package; None where it is not installed, such as a folder on the path."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(name)
    except PackageNotFoundError:
        return None


def __getattr__(name: str) -> str:
    """The version of this package, which takes a while to find."""
    if name != "__version__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return installed_version() or "0+unknown"
