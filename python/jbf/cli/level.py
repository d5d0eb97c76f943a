"""`--false-alarms P`, `--clean-recording`, `--indifference-n X`: thresholds of a detection.

They set the false-alarm rate, the artefact margin and the minimum effect size.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import replace
from typing import TYPE_CHECKING

from jbf.errors import InputError

if TYPE_CHECKING:
    from jbf.cli import Parser
    from jbf.diagnosis.policy import Policy

FALSE_ALARMS, INDIFFERENCE = "--false-alarms", "--indifference-n"


def add(parser: Parser) -> None:
    """Add the options."""
    parser.add_argument(
        FALSE_ALARMS,
        metavar="P",
        type=float,
        help="share of campaigns with nothing hidden in which noise may make a name; 0.01",
    )
    parser.add_argument(
        "--clean-recording",
        action="store_true",
        help="nothing is allowed for what recordings do to a record: an effect must only gain more "
        "than noise does",
    )
    parser.add_argument(
        INDIFFERENCE,
        metavar="X",
        type=float,
        help="RMS by which an effect must change the friction to be named (of a rotary drive in "
        "N m); 3 %% of the residual",
    )


def policy(arguments: argparse.Namespace) -> Policy:
    """Return the policy of a diagnosis with the values of the options.

    Raises
    ------
    InputError
        The false-alarm rate is not between 0 and 1, or the minimum effect size is negative.
    """
    from jbf.diagnosis.policy import DEFAULT

    found, share, force_n = DEFAULT, arguments.false_alarms, arguments.indifference_n
    if share is not None:
        if not 0.0 < share < 1.0:
            raise InputError(
                file=FALSE_ALARMS, problem=f"{share:g} is no share", mend="choose from 0 to 1"
            )
        found = replace(found, false_alarms=share)
    if arguments.clean_recording:
        found = replace(found, imperfection=0.0)
    if force_n is not None:
        if not (math.isfinite(force_n) and force_n >= 0.0):
            raise InputError(
                file=INDIFFERENCE, problem=f"{force_n:g} is no size", mend="give zero or more"
            )
        found = replace(found, indifference=0.0, indifference_n=force_n)
    return found
