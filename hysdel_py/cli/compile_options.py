"""Which options of ``hysdel compile`` belong to which form, and what those have that were not given."""

from __future__ import annotations

import argparse

from hysdel_py.errors import ArgumentError

__all__ = ["check_form"]

_OF_MLD = {"big_m": "lp", "constants": "affine", "share": False, "compact": False}
"""Options that shape the rows and matrices of the MLD form, with the values of those that were not given."""


def check_form(options: argparse.Namespace) -> argparse.Namespace:
    """The options with defaults where none was given.

    Raises
    ------
    ArgumentError
        An option has no effect on the form that is written.
    """
    if options.form == "mld" and options.merge:
        raise ArgumentError("--merge joins modes of the piecewise affine form: add --form pwa, or leave --merge out")
    given = [name for name in _OF_MLD if getattr(options, name)]
    if options.form == "pwa" and given:
        names = ", ".join("--" + name.replace("_", "-") for name in given)
        raise ArgumentError(
            f"{names}: of effect on the MLD form alone, and --form pwa was given: leave out {names}, or --form pwa"
        )
    defaults = {name: value for name, value in _OF_MLD.items() if not getattr(options, name)}
    return argparse.Namespace(**vars(options) | defaults)
