"""The version of the package that is installed."""

from importlib.metadata import PackageNotFoundError, version


def installed_version() -> str:
    """Its number, "0+unknown" where the package is not installed."""
    try:
        return version("fricmb")
    except PackageNotFoundError:
        return "0+unknown"
