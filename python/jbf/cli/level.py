"""`--false-alarm-rate P`, `--no-artefact-margin`, `--min-effect X`: thresholds of a detection.

They set the false-alarm rate, the artefact margin and the minimum effect size.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import replace
from typing import TYPE_CHECKING

from jbf.errors import InputError
from jbf.records.quantities import OF_BEARING, Quantities
from jbf.units.quantity import number_in

if TYPE_CHECKING:
    from jbf.cli import Parser
    from jbf.diagnosis.policy import Policy

FALSE_ALARM_RATE, MIN_EFFECT = "--false-alarm-rate", "--min-effect"


def add(parser: Parser) -> None:
    """Add the options."""
    parser.add_argument(
        FALSE_ALARM_RATE,
        metavar="P",
        type=float,
        help="how often a recording without a missing effect may be given one (default 0.01)",
    )
    parser.add_argument(
        "--no-artefact-margin",
        action="store_true",
        help="assume an ideal recording: require no extra evidence to cover timing and filtering "
        "artefacts",
    )
    parser.add_argument(
        MIN_EFFECT,
        metavar="X",
        help="smallest RMS change of the friction that is reported, in the unit of the rig or as "
        "'0.2 N' (default: 3 %% of the residual)",
    )


def policy(arguments: argparse.Namespace, quantities: Quantities = OF_BEARING) -> Policy:
    """Return the policy of a diagnosis with the values of the options.

    Raises
    ------
    InputError
        The false-alarm rate is not between 0 and 1, or the minimum effect size is negative or not a
        number in the unit of the rig.
    """
    from jbf.diagnosis.policy import DEFAULT

    chosen, rate = DEFAULT, arguments.false_alarm_rate
    if rate is not None:
        if not 0.0 < rate < 1.0:
            raise InputError(
                file=FALSE_ALARM_RATE,
                problem=f"{rate:g} is not a probability",
                mend="choose a number between 0 and 1",
            )
        chosen = replace(chosen, false_alarm_rate=rate)
    if arguments.no_artefact_margin:
        chosen = replace(chosen, artefact_margin=0.0)
    if arguments.min_effect is not None:
        size = number_in(quantities.force, arguments.min_effect, MIN_EFFECT)
        if not (math.isfinite(size) and size >= 0.0):
            raise InputError(
                file=MIN_EFFECT,
                problem=f"{size:g} is negative or infinite",
                mend="use zero or more",
            )
        chosen = replace(chosen, min_effect_share=0.0, min_effect=size)
    return chosen
