"""Policy: every number that influences a verdict, with its meaning and its source.

Other modules of the diagnosis define no such number. `Policy()` is the default of `jbf.diagnose`
and is written to its JSON output. A sensitivity study passes other values
(`diagnose(..., policy=...)`).
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from jbf.comparison.patterns import LEAST_SHARE, SIGNIFICANCE
from jbf.errors import InputError


def _number(value: Any, decides: str, source: str) -> Any:
    return field(default=value, metadata={"decides": decides, "source": source})


@dataclass(frozen=True)
class Policy:
    """Numbers that determine a verdict; evidence is in units of twice the log likelihood.

    Examples
    --------
    >>> policy = jbf.Policy(false_alarm_rate=0.001)
    >>> policy.false_alarm_rate
    0.001
    """

    # ---- evidence for an effect -------------------------------------------------------------
    false_alarm_rate: float = _number(
        0.01,
        "share of campaigns with nothing hidden in which noise may make a name",
        "one in a hundred; the user's to choose",
    )
    artefact_margin: float = _number(
        22.0,
        "what an effect must gain more than noise does, in twice the log likelihood, for what "
        "recordings do to a record and no finding tells",
        "simulated recordings with nothing hidden (benches/recorded); none where the recording is "
        "known to be clean",
    )
    min_effect_share: float = _number(
        0.03,
        "share of the residual's RMS by which an effect must change the friction to be named",
        "what nobody would act on; of long recordings any description is wrong by as much",
    )
    min_effect: float = _number(
        0.0,
        "force, N RMS, by which an effect must change the friction to be named",
        "the user's to choose; none by default",
    )
    least_weight: float = _number(
        0.018,
        "posterior weight, of two effects of equal odds before, with which one could stand in the "
        "other's place; and one replaces another only where that one has less",
        "odds of 55 : 1 (Kass & Raftery 1995: strong); less than one parameter costs",
    )
    most_effects: int = _number(
        5, "effects after which no more are added", "a record that asks for more tells otherwise"
    )
    least_left_out_gain: float = _number(
        0.5,
        "share of what a candidate adds to the log likelihood that it must add to the log "
        "predictive density of left-out runs, where its evidence is weak",
        "of an effect that gains Z + 1 in a linear model (Z - 1) / (Z + 1) is left",
    )
    least_better_runs: float = _number(
        0.66,
        "share of the runs left out that a candidate with strong evidence must predict better, "
        "where it predicts them worse together",
        "two of three: a run that alone tells a parameter is predicted without it",
    )
    left_out_worse: float = _number(
        1.25,
        "times the error on runs left out, without a candidate, that may be left with it",
        "a run that alone tells a parameter is predicted without it, as before; one that is "
        "predicted far worse speaks against it",
    )
    leader_rms: float = _number(
        1.25,
        "times the smallest RMS of all candidates with evidence that the leader's may be",
        "where the model is wrong its smooth error passes for coloured noise, and evidence for "
        "what takes the error away is small",
    )
    weak: float = _number(
        60.0,
        "evidence up to which left-out runs must confirm so much of the gain, and from which a "
        "candidate that fits and does not predict is structure that nothing explains",
        "chosen on simulated campaigns; noise does not reach it",
    )
    refused_rms: float = _number(
        0.99,
        "share of the RMS below which such a candidate fits better at all",
        "what anybody sees who reads it",
    )
    paired: int = _number(
        4,
        "number of candidates that leave the smallest error, and of those with the largest scores "
        "next to the best two, of which pairs are fitted where no single one is accepted and the "
        "residual has structure",
        "chosen for speed",
    )
    # ---- which candidates are fitted --------------------------------------------------------
    least_score: float = _number(
        0.3,
        "share of what one parameter must gain that a score test must promise before an effect is "
        "fitted at all",
        "a step from the null rarely falls short of the fit by more",
    )
    least_swap: float = _number(
        0.05,
        "share of what an effect gains that the score test of another must promise before it is "
        "fitted in its place",
        "what would fit as well promises far more from its null",
    )
    contender: float = _number(
        60.0,
        "how far behind the leader's share a ranked candidate may be and still converge, and how "
        "far a fresh start of many peaks may be behind and still be followed",
        "chosen for speed; never seen to change a verdict",
    )
    close: float = _number(
        0.6, "share of the leader's evidence that a ranked candidate needs to converge", "as above"
    )
    foreseen: float = _number(
        2.0,
        "times what the linear model promises after three steps that a candidate may gain in the "
        "end; where even that is less than the leader's share it is not followed",
        "of fits with effects of every kind the largest gained 1.5 times that",
    )
    promise: float = _number(
        5.0,
        "times what its next step promises that a ranked candidate may still gain",
        "chosen on fits with a ringing drive",
    )
    peaks_share: float = _number(
        0.5,
        "share of the leader's evidence from which on an effect with many peaks is sought at the "
        "others, too",
        "chosen for speed",
    )
    # ---- observation model ------------------------------------------------------------------
    most_terms: int = _number(
        12,
        "number of times that a term of the observation model is added or estimated again",
        "ten terms; delays are estimated again next to a better model",
    )
    most_shifts: int = _number(
        3, "times that the runs' lateness is estimated", "a second look sees it sharper"
    )
    deviation_chance: float = _number(
        1e-4,
        "probability of a false term of the observation model, shared among their kinds",
        "one campaign in ten thousand",
    )
    bias_moves: float = _number(
        0.01,
        "share of a converter's step by which the bias of its steps must move, RMS, to be taken "
        "off anew",
        "a tenth of what it is beside little noise",
    )
    no_worse: float = _number(
        1.03,
        "ratio of held-out errors up to which a term of the observation model predicts no worse, "
        "and from which on a law or a term of the machine predicts better",
        "what a fit of the same model differs by from one half of a recording to the other",
    )
    uneven_noise: float = _number(
        1.25,
        "ratio of the noise's size, between forces or between runs, from which on samples are "
        "weighed by it",
        "below it the weights gain less than 5 % of the variance of a parameter",
    )
    heavy_tails: float = _number(
        6.0,
        "times as many innovations beyond four standard deviations as Gaussian noise has, from "
        "which on large ones count less",
        "least squares lose a twentieth of their precision there",
    )
    # ---- confounders ----------------------------------------------------------------------------
    coarse_steps: float = _number(
        2.0,
        "times the residual's RMS from which on a converter's steps are its tails, and no sample "
        "counts less for lying in them",
        "errors of such steps spread evenly are more than half of its standard deviation",
    )
    clear: float = _number(
        20.0,
        "times what the runs' disagreement on an effect's own parameters is worth that it must "
        "have gained to keep its name where structure remains",
        "chosen on simulated campaigns with effects that are in no catalogue",
    )
    # ---- residual structure -----------------------------------------------------------------
    pattern_share: float = _number(
        LEAST_SHARE,
        "share of the innovations' mean square that a pattern along an axis must explain",
        "the comparison's own",
    )
    pattern_sigma: float = _number(
        SIGNIFICANCE,
        "standard deviations that a pattern must stand above chance",
        "the comparison's own",
    )
    motion_share: float = _number(
        0.08,
        "largest share of the mean square that structure must have, and that a law or an effect "
        "which filters a force or a motion must explain, because of the errors of the motion: "
        "below it, their share of the variance",
        "simulated servo drives (benches/servo_diagnoses.py, seeds 4007 to 4067)",
    )
    motion_effect_share: float = _number(
        0.03,
        "the same for all other effects",
        "twice the largest share that such an effect explained in simulated servo drives without "
        "hidden effects (seeds 4007 to 4036)",
    )
    noise_changes: float = _number(
        1.1,
        "ratio by which the noise next to the errors of the motion must decrease for these to be "
        "estimated again",
        "a tenth of the noise",
    )
    tone_chance: float = _number(
        1e-7,
        "probability at which a spectral line is no chance, over all lines of a run",
        "set before any campaign was seen",
    )
    tone_share: float = _number(
        0.008, "share of the mean square that a tone must have", "set before any campaign was seen"
    )
    replicate_sigma: float = _number(
        5.0,
        "standard errors that the correlation between replicates must be off zero",
        "a chance in two millions of Gaussian noise",
    )
    replicate_share: float = _number(
        0.03, "share of the mean square that comes again and is worth a word", "simulated campaigns"
    )
    burst_sigma: float = _number(
        5.0,
        "standard deviations from which on an innovation is large",
        "one in two millions of Gaussian noise",
    )
    burst_share: float = _number(
        0.008, "share of the mean square that large innovations must have", "simulated campaigns"
    )
    burst_chance: float = _number(
        1e-4,
        "probability at which the neighbours of large innovations have their sign by chance",
        "one campaign in ten thousand, whatever the size and the tails of its noise",
    )
    constancy_chance: float = _number(
        1e-8,
        "probability at which runs that ask for different parameters are no chance",
        "set before any campaign was seen",
    )
    constancy_ratio: float = _number(
        2.5,
        "times its degrees of freedom that the chi-square of constancy must be, besides",
        "simulated campaigns: noise is never quite what it is taken for",
    )
    # ---- limitations of the runs ----------------------------------------------------------------
    one_direction: float = _number(
        0.01,
        "share of the samples in the rarer direction below which the motion has one direction",
        "of such samples no level can be estimated",
    )
    one_speed: float = _number(
        1.5,
        "ratio of the 95 % and 5 % quantiles of the speed below which it hardly changes",
        "a line through such speeds has an intercept with three times its error",
    )
    wide_speeds: float = _number(
        10.0,
        "ratio of these quantiles below which a law is said to be extrapolated",
        "a Stribeck curve extends over decades",
    )
    sliding: float = _number(
        3.0,
        "length of a stroke, in presliding displacements, below which a contact does not slide",
        "a bristle reaches 95 % of its force after three displacements (Dahl 1968)",
    )
    # ---- the next run -----------------------------------------------------------------------
    law_tie: float = _number(
        2.0,
        "standard errors, between stretches of the records, by which a law must predict worse than "
        "the best not to be tied with it",
        "one in forty by chance",
    )
    law_same: float = _number(
        1.005,
        "times the left-out error of the best law that is the same to anybody who uses it",
        "half a per cent",
    )
    least_separation: float = _number(
        25.0,
        "evidence to be expected from a run that is worth proposing; twice that of one that "
        "would show what could hide",
        "five standard deviations",
    )

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if math.isnan(value):
                raise InputError(problem=f"the policy's {name} is nan", mend="give a number")
        for name, most in (("false_alarm_rate", 1.0), ("least_weight", 0.5)):
            value = getattr(self, name)
            if not 0.0 < value < most:
                raise InputError(
                    problem=f"the policy's {name} = {value:g}",
                    mend=f"must be above zero and below {most:g}",
                )

    @property
    def tie(self) -> float:
        """Difference in evidence that corresponds to the weight `least_weight`."""
        return 2.0 * math.log(1.0 / self.least_weight - 1.0)

    def least_share(self, motion_share: float) -> float:
        """Share of the mean square that structure must have, and a law or a filter must explain.

        The errors of the motion contribute a share of the variance, and their covariance is an
        estimate. An effect that filters a force or a motion can explain the same share.

        Parameters
        ----------
        motion_share
            Mean share of the motion's errors in the variance.
        """
        return min(motion_share, self.motion_share)

    def least_effect_share(self, motion_share: float) -> float:
        """Share of the mean square that an effect must explain that is no filter."""
        return min(motion_share, self.motion_effect_share)

    def to_dict(self) -> dict[str, float]:
        """Return a JSON-serialisable dict."""
        return asdict(self)

    @classmethod
    def explained(cls) -> dict[str, tuple[float, str, str]]:
        """Map each name to its default number, its meaning and its source."""
        default = cls()
        return {
            f.name: (getattr(default, f.name), f.metadata["decides"], f.metadata["source"])
            for f in fields(cls)
        }


DEFAULT = Policy()
