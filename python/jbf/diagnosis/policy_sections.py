"""Sections of the policy: selection of effects, terms and laws.

Evidence and gains are in units of twice the log likelihood.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from jbf.estimation.settings import documented

ONE_IN_TEN_THOUSAND = "1 campaign in 10,000"


@dataclass(frozen=True)
class Selection:
    """Thresholds for the acceptance, exchange and removal of effects."""

    max_effects: int = documented(
        5,
        "maximum number of effects in a model",
        "convention: data that need more effects have a structure outside the catalogue",
    )
    max_rms_ratio: float = documented(
        1.25,
        "maximum ratio of the leader's RMS to the smallest RMS of all candidates with evidence",
        "the smooth error of a wrong model resembles coloured noise, and the evidence against it "
        "is small",
    )
    min_weight: float = documented(
        0.018,
        "minimum posterior weight of an effect that is tied with another one; below it the effect "
        "is replaced",
        "odds of 55 : 1 (Kass & Raftery 1995: strong); less than the penalty of one parameter",
    )
    weak_evidence: float = documented(
        60.0,
        "evidence up to which only the predictive density of held-out runs can confirm a "
        "candidate; above it, a candidate that they do not confirm counts as residual structure",
        "chosen on simulated campaigns; noise alone does not exceed it",
    )
    max_refused_rms_ratio: float = documented(
        0.99,
        "ratio of RMS values below which such a candidate counts as fitting better",
        "convention",
    )
    min_size_ratio: float = documented(
        0.1,
        "RMS that an effect explains, relative to that of the largest residual structure or of a "
        "larger effect, below which it is not named",
        "an error of a tenth in the description of this structure",
    )
    confounder_ratio: float = documented(
        20.0,
        "minimum ratio of an effect's gain to the disagreement of the runs on its parameters for "
        "the effect to be named although residual structure remains",
        "chosen on simulated campaigns with effects outside the catalogue",
    )
    min_estimate_sigma: float = documented(
        2.0,
        "minimum difference of a parameter from its null value, in standard errors, for its "
        "effect to be named",
        "a 95 % confidence interval that excludes the null value",
    )

    @property
    def tie(self) -> float:
        """Difference in evidence at which an effect has the posterior weight `min_weight`."""
        return 2.0 * math.log(1.0 / self.min_weight - 1.0)


@dataclass(frozen=True)
class HeldOut:
    """Thresholds for the confirmation of effects and terms by held-out runs."""

    min_gain_share: float = documented(
        0.5,
        "increase of the log predictive density of held-out runs, as a share of the candidate's "
        "gain, above which they confirm the candidate",
        "in a linear model the expected share is (Z - 1) / (Z + 1) for a gain Z + 1",
    )
    min_better_share: float = documented(
        0.66,
        "minimum share of the held-out runs that a candidate with strong evidence must predict "
        "better, where its error over all of them is larger",
        "two of three: if only one run determines a parameter, that run is predicted without it",
    )
    max_rms_ratio: float = documented(
        1.25,
        "maximum ratio of the held-out RMS with a candidate to that without it",
        "a run that is predicted far worse contradicts the candidate",
    )
    no_worse_ratio: float = documented(
        1.03,
        "ratio of held-out RMS values up to which a term, or an exchanged effect, counts as "
        "predicting equally well, and above which a law counts as predicting better",
        "typical difference between fits of one model to the two halves of a recording",
    )


@dataclass(frozen=True)
class Search:
    """Criteria by which candidates are fitted approximately or to convergence."""

    min_score_share: float = documented(
        0.3,
        "minimum gain that a score test must predict for a candidate to be fitted, as a share of "
        "the threshold for one parameter",
        "one step from the null rarely underestimates the gain of the fit by more",
    )
    min_swap_share: float = documented(
        0.25,
        "minimum gain that the score test of another effect must predict for an exchange, as a "
        "share of the present effect's gain",
        "in fits of servo drives and machines, the gain was at most 3.9 times the predicted one",
    )
    rank_margin: float = documented(
        60.0,
        "a new start of a multimodal likelihood is continued if it is less than this below the "
        "highest maximum; a refit that gains more shows that the first fit was a local minimum",
        "chosen for speed; no change of a verdict was observed",
    )
    linear_gain_factor: float = documented(
        2.0,
        "assumed maximum ratio of a candidate's gain to the gain that the linear model predicts "
        "after three evaluations; a candidate that cannot tie with the leader is not continued",
        "the largest observed ratio, in fits with effects of every kind, was 1.5",
    )
    step_gain_factor: float = documented(
        5.0,
        "assumed maximum ratio of a candidate's remaining gain to the gain of its next step",
        "chosen on fits with a ringing drive",
    )
    min_peaks_fraction: float = documented(
        0.5,
        "minimum share of the leader's evidence for an effect with a multimodal likelihood to be "
        "searched at its other maxima",
        "chosen for speed",
    )
    group_size: int = documented(
        4,
        "number of candidates that are fitted approximately at a time; their evidence decides "
        "which later ones are skipped",
        "chosen for speed",
    )
    leaders: int = documented(
        3,
        "number of candidates with the largest gains that are tested by independent units, and of "
        "replacements of an effect that are tested",
        "chosen for speed",
    )
    paired: int = documented(
        4,
        "number of candidates with the smallest error, and of those with the largest scores in "
        "addition to the best two, of which pairs are fitted if no single candidate is accepted",
        "chosen for speed",
    )


@dataclass(frozen=True)
class Terms:
    """Thresholds for terms of the observation model."""

    chance: float = documented(
        1e-4,
        "probability of a false term per campaign, divided among the kinds",
        ONE_IN_TEN_THOUSAND,
    )
    kinds: int = documented(
        10,
        "number of kinds of terms among which this probability is divided",
        "offset, drift, gain and oil by run, delay by run, clock drift, quantiser, variance by "
        "force and by run, heavy tails",
    )
    max_updates: int = documented(
        12,
        "maximum number of times that a term is added or re-estimated",
        "ten kinds; delays are re-estimated with a better model",
    )


@dataclass(frozen=True)
class Delays:
    """Thresholds for time delays of runs and a clock drift."""

    max_searches: int = documented(
        3,
        "maximum number of searches for the delays of the runs",
        "a second search is more precise",
    )
    hint_chance: float = documented(
        0.05, "significance level below which a clock drift is fitted", "1 in 20"
    )
    drift_square_factor: float = documented(
        0.5,
        "factor on the Wald statistic of a clock drift",
        "the residual of a wrong model is not white",
    )


@dataclass(frozen=True)
class Quantisation:
    """Thresholds for the bias of readings of a converter with coarse quantisation."""

    min_bias_change: float = documented(
        0.01,
        "change of the bias, RMS in steps, above which the correction is repeated",
        "a tenth of the bias at a low noise level",
    )
    unbiased_noise: float = documented(
        0.8,
        "standard deviation of the noise, in steps, above which readings count as unbiased",
        "the bias is below 1e-5 steps",
    )


@dataclass(frozen=True)
class NoiseVariance:
    """Thresholds for heteroscedastic and heavy-tailed noise."""

    min_ratio: float = documented(
        1.25,
        "minimum ratio of noise levels, between forces or runs, for samples to be weighted",
        "below it, weights reduce the variance of a parameter by less than 5 %",
    )
    force_bins: int = documented(
        6, "number of bins of the force in which a noise level is estimated", "convention"
    )
    min_samples: int = documented(
        200, "minimum number of samples for an estimate of a noise level", "an error of 13 %"
    )
    min_tail_ratio: float = documented(
        6.0,
        "minimum ratio of the number of innovations in the tails to that of Gaussian noise for "
        "them to be downweighted",
        "least squares lose 5 % of their precision there",
    )
    tail_sigma: float = documented(
        4.0, "standard deviations beyond which an innovation is in the tails", "6 in 100,000"
    )
    min_tails: float = documented(
        5.0, "minimum number of innovations in the tails", "more than single outliers"
    )
    huber_sigma: float = documented(
        2.5, "standard deviations beyond which an innovation is downweighted", "Huber (1964)"
    )
    max_step_ratio: float = documented(
        2.0,
        "ratio of a converter's step to the residual's RMS above which heavy tails are not "
        "estimated",
        "quantisation errors are then more than half of the standard deviation",
    )


@dataclass(frozen=True)
class Motion:
    """Thresholds that depend on the errors of the estimated motion."""

    max_structure_share: float = documented(
        0.08,
        "share of the mean square that structure must explain where the errors of the motion have "
        "a larger share of the variance",
        "simulated servo drives (benches/servo_diagnoses.py, seeds 4007 to 4067)",
    )
    max_scale: float = documented(
        3.0,
        "scale of the standard errors of the motion above which the residual contains more than "
        "errors of the motion",
        "the standard errors of the smoother are right within a factor of three; 0.4 to 0.9 in "
        "simulated drives without structure",
    )
    max_pattern_ratio: float = documented(
        1.5,
        "ratio of a residual pattern with a motion that is smoothed less, or its reciprocal, above "
        "which the pattern is an error of the smoothing",
        "1.0 to 1.2 for friction, at most 0.6 or above 1.7 for smoothing in simulated servo drives "
        "(seeds 4850 to 4877)",
    )
    max_effect_share: float = documented(
        0.015,
        "share of the mean square that an effect or a better law must explain where the errors of "
        "the motion have a larger share of the variance",
        "false effects explained less in most simulated servo drives (seeds 4938 to 5012)",
    )
    min_filter_share: float = documented(
        0.015,
        "smallest share of the mean square that an effect that filters the force in time must "
        "explain; not for a bearing",
        "the value of max_effect_share; a lag that smooths the noise of a recorded load explains "
        "less",
    )


@dataclass(frozen=True)
class Limitations:
    """Thresholds for conclusions that the motions of the runs do not support."""

    min_reverse_share: float = documented(
        0.01,
        "share of the samples in the rarer direction below which the motion counts as "
        "unidirectional",
        "fewer samples do not determine a friction level",
    )
    min_speed_ratio: float = documented(
        1.5,
        "ratio of the 95 % and 5 % quantiles of the speed below which the speed counts as constant",
        "a line through such speeds has an intercept with three times its error",
    )
    wide_speed_ratio: float = documented(
        10.0,
        "ratio of these quantiles below which a law is extrapolated",
        "a Stribeck curve extends over decades",
    )
    min_sliding: float = documented(
        3.0,
        "length of a stroke, in presliding displacements, below which a contact does not slide",
        "a bristle reaches 95 % of its force after three displacements (Dahl 1968)",
    )


@dataclass(frozen=True)
class Laws:
    """Thresholds for the comparison of base laws."""

    tie_sigma: float = documented(
        3.0,
        "standard errors, between sections of the records, up to which a law is tied with the best",
        "1 in 700 by chance for each of up to nine laws",
    )
    same_ratio: float = documented(
        1.005,
        "ratio of held-out errors up to which two laws or models count as equivalent",
        "0.5 %",
    )
    sections: int = documented(
        40,
        "number of sections of the records",
        "errors of neighbouring samples are correlated; sections are nearly independent",
    )
    budget_share: float = documented(
        0.25, "share of the computing budget above which a law is not evaluated", "a quarter"
    )
    time_share: float = documented(
        0.5, "share of a time limit after which no further law is evaluated", "a half"
    )


@dataclass(frozen=True)
class Experiments:
    """Thresholds for the proposal of further runs."""

    min_evidence: float = documented(
        25.0,
        "expected evidence between tied models from which a run is proposed, and half of that "
        "needed to detect an effect",
        "five standard deviations",
    )
    strengths: tuple[float, ...] = documented(
        (0.6, 1.0, 1.5),
        "multiples of the typical strength of an effect, equally likely",
        "convention",
    )
