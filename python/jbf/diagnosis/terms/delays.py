"""Time delay of the force by run, and drift of the clock of the force channel.

The force is compared with the motion at the sampling instants of the force. A delay common to all
runs is the effect `time_delay`; a force that is early in all runs is a recording artefact.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import special

from jbf.diagnosis.policy import Policy
from jbf.diagnosis.terms.proposal import Model, Proposal, price_of_term
from jbf.diagnosis.terms.shifts import (
    Shifted,
    fit_clock_drift,
    fit_common_delay,
    fit_delays_by_run,
    fit_delays_by_search,
    with_mean_delay,
)
from jbf.estimation.campaign import Campaign
from jbf.estimation.delays import drift_step, run_delay_step
from jbf.estimation.likelihood import independent_share
from jbf.estimation.solution import Solution
from jbf.estimation.uncertain_samples import samples_near_jumps
from jbf.models.catalogue import find_effect
from jbf.records.findings.finding import Finding

LATE, DRIFT = "late_channel", "drifting_clock"


def delays(model: Model) -> Proposal | None:
    """Propose delays by run or a clock drift, whichever has the larger evidence.

    Returns None if neither is significant.
    """
    campaign = model.campaign
    if not campaign.force_has_clock or campaign.samples.motion is not None:
        return None
    if any(f.kind == DRIFT for f in campaign.more_findings):
        return None
    proposals, estimates = [], _estimates(model)
    if not estimates:
        return None
    best = min((estimate.solution for estimate in estimates), key=lambda s: s.rms)
    counted = zip(best.residuals, best.samples.counted, strict=True)
    steps_s, noise = best.samples.steps_s, best.samples.settings.noise
    share = min(independent_share([r * c for r, c in counted], steps_s, noise), 1.0)
    for estimate in estimates:
        price = price_of_term(model.policy)
        if estimate.drift == 0.0 and np.mean(estimate.delays_s) > 0.0:
            # The mean delay corresponds to an effect: add the threshold of an effect.
            price += model.price_of_effect
        price -= model.price_of_effect * max(model.reference.free - estimate.solution.free, 0)
        shifted = estimate.campaign.with_findings(_findings(known_delays(campaign), estimate))
        gain = _gain(estimate, model.reference, share)
        proposals.append(Proposal(shifted, estimate.problem, estimate.solution, gain, price))
    return max(proposals, key=lambda p: p.evidence)


def known_delays(campaign: Campaign) -> dict[str, float]:
    """Force delays that are already corrected in a campaign, s, by run."""
    return {f.run: f.size for f in campaign.more_findings if f.kind == LATE}


def explained_by_delays(effects: Sequence[str]) -> tuple[str, ...]:
    """Effects of a model that run-specific time delays may explain instead.

    These are effects of the instrument, and effects that shift friction jumps.
    """
    pages = {name: find_effect(name) for name in effects}
    return tuple(n for n, e in pages.items() if e.stage == "instrument" or e.moves_jumps)


def _estimates(model: Model) -> list[Shifted]:
    """Estimate the time shifts of the force of each run by several methods.

    The shifts are estimated jointly with the model, as the drift of one clock, and as the delays
    with the smallest sums of squares.
    """
    problem, solution, policy = model.problem, model.solution, model.policy
    start = Shifted(problem, solution, np.zeros(len(problem.campaign.prepared)), 0.0)
    estimates = []
    if run_delay_step(problem, solution).p_value < policy.terms.chance:
        by_run = fit_delays_by_run(start)
        estimates.append(by_run if _significant(by_run, policy) else with_mean_delay(by_run))
    if not known_delays(problem.campaign):
        # The model parameters compensate for a drift: test it at a less strict significance level
        # before it is fitted (`_significant` tests it again afterwards).
        if special.chdtrc(1, drift_step(problem, solution).square) < policy.delays.hint_chance:
            estimates.append(fit_clock_drift(start))
        coarse = fit_delays_by_search(problem, solution, policy)
        if coarse is not None:
            estimates.append(fit_common_delay(problem, coarse) if coarse.drift == 0.0 else coarse)
    return [f for f in estimates if f is not start and _significant(f, policy)]


def _significant(shifted: Shifted, policy: Policy) -> bool:
    """Whether a clock drift, or the differences between the delays of the runs, are significant.

    A delay that is equal in all runs is part of the effect `time_delay`, unless it is negative.
    """
    problem, solution = shifted.problem, shifted.solution
    if shifted.drift != 0.0:
        # The residual of a wrong model is not white: reduce the Wald statistic.
        square = (
            policy.delays.drift_square_factor
            * shifted.drift**2
            / drift_step(problem, solution).variance
        )
        # A delay common to all runs resembles a drift.
        joint = drift_step(problem, solution, with_delay=True)
        joint_square = (shifted.drift + joint.drift) ** 2 / joint.variance
        return bool(
            special.chdtrc(1, square) < policy.terms.chance
            and special.chdtrc(1, joint_square) < policy.delays.hint_chance
        )
    if np.ptp(shifted.delays_s) == 0.0:
        return bool(shifted.delays_s[0] < 0.0)
    step = run_delay_step(problem, solution)
    return step.differences_p_value(shifted.delays_s) < policy.terms.chance


def _gain(shifted: Shifted, other: Solution, share: float) -> float:
    """Gain of a model of time-shifted runs over another, in twice the log marginal likelihood.

    Delays that differ between runs are a random effect, whose number of parameters is included in
    the determinant of its covariance. `share` is the effective number of samples divided by their
    number.
    """
    solution = shifted.solution
    prepared = shifted.campaign.prepared
    forces = [p.friction - r for p, r in zip(prepared, solution.residuals, strict=True)]
    # Samples that the other model excludes next to jumps are excluded here as well.
    samples = samples_near_jumps(solution.samples, prepared, forces, other.effects)
    after = samples.without_deviations(solution.residuals, solution.noise)
    before = other.samples.without_deviations(other.residuals, other.noise)
    ratio = other.samples.rms(before) / max(samples.rms(after), 1e-300)
    gain = 2.0 * share * other.samples.count * float(np.log(max(ratio, 1e-300)))
    return gain - _log_determinant(shifted)


def _log_determinant(shifted: Shifted) -> float:
    """Log-determinant of the covariance of the delays; zero for a drift or equal delays."""
    if shifted.drift != 0.0 or np.ptp(shifted.delays_s) == 0.0:
        return 0.0
    step = run_delay_step(shifted.problem, shifted.solution)
    delays_s = shifted.delays_s[step.identifiable]
    if len(delays_s) < 2:
        return 0.0
    variance = float(np.var(delays_s, ddof=1))
    return float(np.sum(np.log1p(variance / np.diag(step.covariance_s2))))


def _findings(before_s: dict[str, float], shifted: Shifted) -> list[Finding]:
    """Findings on the delays that changed, compared with the delays known before."""
    return [
        _finding(p.run.name, late + before_s.get(p.run.name, 0.0), shifted.drift)
        for p, late in zip(shifted.campaign.prepared, shifted.delays_s.tolist(), strict=True)
    ]


def _finding(run: str, delay_s: float, drift: float) -> Finding:
    """Finding on the delay (s) and the relative clock drift of one run."""
    if drift == 0.0:
        way = "late" if delay_s > 0.0 else "early"
        words = f"the force is {1e3 * abs(delay_s):.2g} ms {way} relative to the motion"
        return Finding(LATE, "friction_n", run, delay_s, "s", "shifted", words)
    way = "slow" if drift > 0.0 else "fast"
    words = (
        f"the force clock is {1e6 * abs(drift):.0f} ppm {way} relative to the motion "
        f"clock ({1e3 * delay_s:+.2g} ms at mid-run)"
    )
    return Finding(DRIFT, "friction_n", run, drift, "1", "shifted", words)
