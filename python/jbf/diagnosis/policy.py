"""Policy: every number that influences a verdict, with its meaning and its source.

Other modules of the diagnosis define no such number (`python/tests/project/test_constants.py`).
`Policy()` is the default of `jbf.diagnose`, and its JSON output contains the values by dotted name.
A sensitivity study passes other values: `Policy().with_values({"delays.max_searches": 1})`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

from jbf.diagnosis import policy_residual as residual
from jbf.diagnosis import policy_sections as sections
from jbf.errors import InputError
from jbf.estimation.settings import Settings, documented


@dataclass(frozen=True)
class Policy:
    """Thresholds and settings that determine a verdict.

    Four of them are chosen by the user: the false-alarm rate, the artefact margin and the two
    minimum effect sizes. The others are grouped into sections by purpose; those of the estimation
    are in `estimation`. Evidence is in units of twice the log likelihood.

    Examples
    --------
    >>> policy = jbf.Policy(false_alarm_rate=0.001)
    >>> policy.false_alarm_rate
    0.001
    """

    false_alarm_rate: float = documented(
        0.01,
        "family-wise type I error: share of campaigns without a missing effect in which noise "
        "leads to a named effect",
        "one in a hundred; the user's choice",
    )
    artefact_margin: float = documented(
        22.0,
        "gain that an effect needs in addition to the noise threshold, because of recording "
        "artefacts that no finding reports",
        "simulated recordings without effects (benches/recorded); zero for a clean recording",
    )
    min_effect_share: float = documented(
        0.03,
        "share of the residual's RMS by which an effect must change the friction to be named",
        "practical significance; with enough samples any small lack of fit is statistically "
        "significant",
    )
    min_effect: float = documented(
        0.0,
        "RMS, in the unit of the force, by which an effect must change the friction to be named",
        "the user's choice; zero by default",
    )
    selection: sections.Selection = field(default_factory=sections.Selection)
    held_out: sections.HeldOut = field(default_factory=sections.HeldOut)
    search: sections.Search = field(default_factory=sections.Search)
    terms: sections.Terms = field(default_factory=sections.Terms)
    delays: sections.Delays = field(default_factory=sections.Delays)
    quantisation: sections.Quantisation = field(default_factory=sections.Quantisation)
    noise: sections.NoiseVariance = field(default_factory=sections.NoiseVariance)
    motion: sections.Motion = field(default_factory=sections.Motion)
    patterns: residual.Patterns = field(default_factory=residual.Patterns)
    tones: residual.Tones = field(default_factory=residual.Tones)
    ripples: residual.Ripples = field(default_factory=residual.Ripples)
    replicates: residual.Replicates = field(default_factory=residual.Replicates)
    bursts: residual.Bursts = field(default_factory=residual.Bursts)
    momentum: residual.Momentum = field(default_factory=residual.Momentum)
    constancy: residual.Constancy = field(default_factory=residual.Constancy)
    strokes: residual.Strokes = field(default_factory=residual.Strokes)
    limitations: sections.Limitations = field(default_factory=sections.Limitations)
    laws: sections.Laws = field(default_factory=sections.Laws)
    experiments: sections.Experiments = field(default_factory=sections.Experiments)
    estimation: Settings = field(default_factory=Settings)

    def __post_init__(self) -> None:
        for name, value in self.to_dict().items():
            if isinstance(value, float) and math.isnan(value):
                raise InputError(problem=f"the policy's {name} is nan", remedy="give a number")
        for name, value, most in (
            ("false_alarm_rate", self.false_alarm_rate, 1.0),
            ("selection.min_weight", self.selection.min_weight, 0.5),
        ):
            if not 0.0 < value < most:
                raise InputError(
                    problem=f"the policy's {name} = {value:g}",
                    remedy=f"must be above zero and below {most:g}",
                )

    def least_share(self, motion_share: float) -> float:
        """Minimum share of the mean square that residual structure must explain.

        The minimum increases with the contribution of the motion's errors, because their covariance
        is only estimated.

        Parameters
        ----------
        motion_share
            Mean share of the motion's errors in the variance of the residual.
        """
        return min(motion_share, self.motion.max_structure_share)

    def least_effect_share(self, motion_share: float) -> float:
        """Minimum share of the mean square that an effect or a better law must explain.

        It is the share of the motion's errors in the variance, up to `motion.max_effect_share`.
        """
        return min(motion_share, self.motion.max_effect_share)

    def with_values(self, values: Mapping[str, Any]) -> Policy:
        """Return a copy of the policy with some values replaced, given by dotted name.

        Raises
        ------
        InputError
            An unknown name, or a value outside its range.
        """
        changed = self
        for name, value in values.items():
            if name not in changed.to_dict():
                raise InputError(
                    problem=f"the policy has no value {name}", remedy="see jbf.Policy().to_dict()"
                )
            changed = _replaced(changed, name.split("."), value)
        return changed

    def to_dict(self) -> dict[str, Any]:
        """Return the values of all fields by dotted name, JSON-serialisable."""
        return {name: getattr(owner, leaf) for name, owner, leaf, _ in _numbers(self)}

    @classmethod
    def explained(cls) -> dict[str, tuple[Any, str, str]]:
        """Map each dotted name to its default, its meaning and its source."""
        return {
            name: (getattr(owner, leaf), metadata["decides"], metadata["source"])
            for name, owner, leaf, metadata in _numbers(cls())
        }


def _numbers(section: Any, before: str = "") -> Iterator[tuple[str, Any, str, Mapping[Any, Any]]]:
    """Dotted name, section, field name and metadata of each number of a policy section."""
    for f in fields(section):
        value = getattr(section, f.name)
        if is_dataclass(value):
            yield from _numbers(value, f"{before}{f.name}.")
        else:
            yield before + f.name, section, f.name, f.metadata


def _replaced(section: Any, path: list[str], value: Any) -> Any:
    """Copy of a policy section in which the field at `path` has another value."""
    first, *rest = path
    inner = _replaced(getattr(section, first), rest, value) if rest else value
    return replace(section, **{first: inner})


DEFAULT = Policy()
