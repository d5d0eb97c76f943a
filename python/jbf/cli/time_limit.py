"""`--time-limit S`: duration after which a fit or a diagnosis ends with its best model so far."""

from __future__ import annotations

from argparse import _ActionsContainer
from typing import TYPE_CHECKING

from jbf.errors import InputError
from jbf.units.quantity import number_in

if TYPE_CHECKING:
    from jbf.estimation.work import TimeLimit

OPTION = "--time-limit"


def add(parser: _ActionsContainer, then: str) -> None:
    """Add the option; `then` describes the result at the limit."""
    parser.add_argument(OPTION, metavar="S", help=f"time limit, s or as '2 min'; {then}")


def time_limit(text: str | None) -> TimeLimit | None:
    """Return the time limit that begins now; None without the option.

    Raises
    ------
    InputError
        The text is not a positive duration.
    """
    if text is None:
        return None
    from jbf.estimation.work import TimeLimit

    seconds = number_in("s", text, OPTION)
    try:
        return TimeLimit(seconds)
    except InputError as error:
        raise InputError(
            file=OPTION, problem=f"{seconds:g} s is not a duration", remedy=error.remedy
        ) from None
