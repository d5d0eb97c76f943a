"""Options for the thresholds of a detection: `--false-alarm-rate`, `--min-effect` and so on.

The options set the false-alarm rate, the artefact margin and the minimum effect size.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jbf.errors import InputError
from jbf.records.quantities import BEARING, Quantities
from jbf.units.quantity import number_in

if TYPE_CHECKING:
    from jbf.cli import Parser
    from jbf.diagnosis.policy import Policy

FALSE_ALARM_RATE, MIN_EFFECT = "--false-alarm-rate", "--min-effect"


def add(parser: Parser) -> None:
    """Add the options that set the thresholds of a detection."""
    parser.add_argument(
        FALSE_ALARM_RATE,
        metavar="P",
        type=float,
        help="how often a clean recording may be blamed by mistake (default 0.01)",
    )
    parser.add_argument(
        "--no-artefact-margin",
        action="store_true",
        help="assume an ideal logger: do not demand extra evidence to cover timing and filtering "
        "artefacts",
    )
    parser.add_argument(
        MIN_EFFECT,
        metavar="X",
        help="smallest RMS change of the friction for which an effect is named, in the unit of the "
        "rig or as '0.2 N' (default: 3 %% of the residual)",
    )


@dataclass(frozen=True)
class LevelOptions:
    """Options for the thresholds of a detection; None for the default.

    Attributes
    ----------
    false_alarm_rate
        Fraction of campaigns without a missing effect in which one may be named.
    no_artefact_margin
        Whether the margin for recording artefacts is omitted.
    min_effect
        Smallest RMS change of the friction for which an effect is named, with or without a unit.
    """

    false_alarm_rate: float | None
    no_artefact_margin: bool
    min_effect: str | None

    def policy(self, quantities: Quantities = BEARING) -> Policy:
        """Return the policy of a diagnosis with these thresholds.

        Raises
        ------
        InputError
            The false-alarm rate is not between 0 and 1, or the minimum effect size is not zero or
            more in the unit of the rig.
        """
        from jbf.diagnosis.policy import DEFAULT

        policy, rate = DEFAULT, self.false_alarm_rate
        if rate is not None:
            if not 0.0 < rate < 1.0:
                raise InputError(
                    file=FALSE_ALARM_RATE,
                    problem=f"{rate:g} is not a probability",
                    remedy="choose a number between 0 and 1",
                )
            policy = replace(policy, false_alarm_rate=rate)
        if self.no_artefact_margin:
            policy = replace(policy, artefact_margin=0.0)
        if self.min_effect is not None:
            size = number_in(quantities.force, self.min_effect, MIN_EFFECT)
            if not (math.isfinite(size) and size >= 0.0):
                raise InputError(
                    file=MIN_EFFECT,
                    problem=f"{size:g} is not an effect size",
                    remedy="choose zero or a positive number",
                )
            policy = replace(policy, min_effect_share=0.0, min_effect=size)
        return policy
