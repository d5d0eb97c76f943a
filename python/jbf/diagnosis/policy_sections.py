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
    """Acceptance, exchange and removal of effects."""

    max_effects: int = documented(
        5,
        "number of effects after which no more are added",
        "convention: a record that needs more has another structure",
    )
    max_rms_ratio: float = documented(
        1.25,
        "ratio of the leader's RMS to the smallest RMS of all candidates with evidence, at most",
        "a wrong model's smooth error passes for coloured noise, and evidence against it is small",
    )
    min_weight: float = documented(
        0.018,
        "posterior weight from which an effect is tied with another one; an effect with less is "
        "replaced",
        "odds of 55 : 1 (Kass & Raftery 1995: strong); less than one parameter costs",
    )
    weak_evidence: float = documented(
        60.0,
        "evidence up to which held-out runs must confirm a share of the gain, and above which a "
        "candidate that fits but does not predict is residual structure",
        "chosen on simulated campaigns; noise does not reach it",
    )
    max_refused_rms_ratio: float = documented(
        0.99, "ratio of RMS values below which such a candidate fits better", "convention"
    )
    confounder_ratio: float = documented(
        20.0,
        "ratio of an effect's gain to the runs' disagreement on its parameters from which it is "
        "named although structure remains",
        "chosen on simulated campaigns with effects that are in no catalogue",
    )
    min_estimate_sigma: float = documented(
        2.0,
        "standard errors by which a parameter of an effect must differ from its null for the "
        "effect to be named",
        "a 95 % confidence interval that excludes the null",
    )

    @property
    def tie(self) -> float:
        """Difference in evidence that corresponds to the weight `min_weight`."""
        return 2.0 * math.log(1.0 / self.min_weight - 1.0)


@dataclass(frozen=True)
class HeldOut:
    """Confirmation by held-out runs."""

    min_gain_share: float = documented(
        0.5,
        "share of a candidate's gain by which it must increase the log predictive density of "
        "held-out runs, where its evidence is weak",
        "in a linear model (Z - 1) / (Z + 1) of a gain Z + 1 remains",
    )
    min_better_share: float = documented(
        0.66,
        "share of the held-out runs that a candidate with strong evidence must predict better, "
        "where it predicts all of them together worse",
        "two of three: a run that alone determines a parameter is predicted without it",
    )
    max_rms_ratio: float = documented(
        1.25,
        "ratio of the held-out RMS with a candidate to that without it, at most",
        "a run that is predicted far worse contradicts the candidate",
    )
    no_worse_ratio: float = documented(
        1.03,
        "ratio of held-out RMS values up to which a term predicts no worse, and from which a law "
        "predicts better",
        "fits of one model to two halves of a recording differ by as much",
    )


@dataclass(frozen=True)
class Search:
    """Selection of the candidates to fit, and of those to fit to convergence."""

    min_score_share: float = documented(
        0.3,
        "share of the threshold of one parameter that a score test must predict for a fit",
        "a step from the null rarely falls short of the fit by more",
    )
    min_swap_share: float = documented(
        0.05,
        "share of an effect's gain that the score test of another must predict for an exchange",
        "an effect that fits as well predicts far more from its null",
    )
    rank_margin: float = documented(
        60.0,
        "gain behind the leader's share up to which a candidate converges, and a fresh start of "
        "many peaks is followed",
        "chosen for speed; never seen to change a verdict",
    )
    rank_fraction: float = documented(
        0.6,
        "share of the leader's evidence that a candidate needs to converge",
        "chosen for speed; never seen to change a verdict",
    )
    linear_gain_factor: float = documented(
        2.0,
        "multiple of the gain that the linear model predicts after three steps that a candidate "
        "may reach; it is not followed where this is less than the leader's share",
        "the largest ratio in fits with effects of every kind was 1.5",
    )
    step_gain_factor: float = documented(
        5.0,
        "multiple of the gain of its next step that a candidate may still gain",
        "chosen on fits with a ringing drive",
    )
    min_peaks_fraction: float = documented(
        0.5,
        "share of the leader's evidence from which an effect with many peaks is also searched at "
        "the others",
        "chosen for speed",
    )
    leaders: int = documented(
        3, "number of candidates with the largest gains that may lead", "chosen for speed"
    )
    paired: int = documented(
        4,
        "number of candidates with the smallest error, and of those with the largest scores next "
        "to the best two, of which pairs are fitted where no single one is accepted",
        "chosen for speed",
    )


@dataclass(frozen=True)
class Terms:
    """Terms of the observation model."""

    chance: float = documented(
        1e-4, "probability of a false term, shared among the kinds", ONE_IN_TEN_THOUSAND
    )
    kinds: int = documented(
        10,
        "number of kinds of terms that share this probability",
        "offset, drift, gain and oil by run, delay by run, clock drift, quantiser, variance by "
        "force and by run, heavy tails",
    )
    max_updates: int = documented(
        12,
        "number of times that a term is added or estimated again",
        "ten kinds; delays are estimated again next to a better model",
    )


@dataclass(frozen=True)
class Delays:
    """Significance of delays by run and of a clock drift."""

    max_searches: int = documented(
        3, "number of searches for the delays of the runs", "a second search is more precise"
    )
    hint_chance: float = documented(
        0.05, "significance level below which a clock drift is fitted", "1 in 20"
    )
    drift_square_factor: float = documented(
        0.5,
        "factor on Wald's statistic of a clock drift",
        "the residual of a wrong model is not white",
    )


@dataclass(frozen=True)
class Quantisation:
    """Bias of the readings of a converter with coarse quantisation."""

    min_bias_change: float = documented(
        0.01,
        "change of the bias, RMS in steps, from which it is removed again",
        "a tenth of its size next to little noise",
    )
    unbiased_noise: float = documented(
        0.8,
        "standard deviation of the noise, in steps, from which readings are unbiased",
        "the bias is below 1e-5 steps",
    )


@dataclass(frozen=True)
class NoiseVariance:
    """Heteroscedastic and heavy-tailed noise."""

    min_ratio: float = documented(
        1.25,
        "ratio of noise levels, between forces or runs, from which samples are weighted by it",
        "below it the weights gain less than 5 % of the variance of a parameter",
    )
    force_bins: int = documented(
        6, "number of bins of the force in which a noise level is estimated", "convention"
    )
    min_samples: int = documented(
        200, "number of samples from which a noise level is estimated", "an error of 13 %"
    )
    min_tail_ratio: float = documented(
        6.0,
        "ratio of the number of innovations in the tails to that of Gaussian noise from which "
        "they have less weight",
        "least squares lose a twentieth of their precision there",
    )
    tail_sigma: float = documented(
        4.0, "standard deviations from which an innovation is in the tails", "6 in 100,000"
    )
    min_tails: float = documented(
        5.0, "number of innovations in the tails, at least", "no single outliers"
    )
    huber_sigma: float = documented(
        2.5, "standard deviations from which an innovation has less weight", "Huber (1964)"
    )
    max_step_ratio: float = documented(
        2.0,
        "ratio of a converter's step to the residual's RMS from which no tails are estimated",
        "the tails are then quantisation errors: more than half of the standard deviation",
    )


@dataclass(frozen=True)
class Motion:
    """Errors of the estimated motion."""

    max_structure_share: float = documented(
        0.08,
        "share of the mean square that structure, or an effect that filters a force or a motion, "
        "must explain where the errors of the motion have a larger share of the variance",
        "simulated servo drives (benches/servo_diagnoses.py, seeds 4007 to 4067)",
    )
    max_effect_share: float = documented(
        0.03,
        "the same for all other effects",
        "twice the largest share that such an effect explained in simulated servo drives without "
        "hidden effects (seeds 4007 to 4036)",
    )
    min_noise_ratio: float = documented(
        1.1,
        "ratio by which the noise next to the errors of the motion must decrease for these to be "
        "estimated again",
        "a tenth of the noise",
    )


@dataclass(frozen=True)
class Limitations:
    """Conclusions that the motions of the runs do not support."""

    min_reverse_share: float = documented(
        0.01,
        "share of the samples in the rarer direction below which the motion has one direction",
        "no level can be estimated from fewer",
    )
    min_speed_ratio: float = documented(
        1.5,
        "ratio of the 95 % and 5 % quantiles of the speed below which it hardly changes",
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
    """Comparison of base laws."""

    tie_sigma: float = documented(
        2.0,
        "standard errors, between sections of the records, up to which a law is tied with the best",
        "1 in 40 by chance",
    )
    same_ratio: float = documented(
        1.005, "ratio of held-out errors up to which two laws are the same", "0.5 %"
    )
    sections: int = documented(
        40,
        "number of sections of the records",
        "errors of neighbouring samples are correlated; sections are nearly independent",
    )
    budget_share: float = documented(
        0.25, "share of the computing budget above which a law is not evaluated", "a quarter"
    )


@dataclass(frozen=True)
class Experiments:
    """Proposed runs."""

    min_evidence: float = documented(
        25.0,
        "expected evidence between tied models from which a run is proposed, and half of that "
        "needed to detect an effect",
        "five standard deviations",
    )
    strengths: tuple[float, ...] = documented(
        (0.6, 1.0, 1.5),
        "multiples of the usual strength of an effect, equally likely",
        "convention",
    )
