"""Comparison of diagnoses of the same runs with different laws."""

from __future__ import annotations

from collections.abc import Sequence

from jbf.comparison.comparison import compare_prepared
from jbf.diagnosis.result import Diagnosis
from jbf.diagnosis.which_law import LawTried
from jbf.estimation.campaign import Campaign
from jbf.estimation.posterior_motions import aligned, delays_by_run_s


def may_predict_better(law: str, best: Diagnosis, laws: Sequence[LawTried], margin: float) -> bool:
    """Whether a further law may predict better than the best diagnosed law with its effects.

    `laws` has the held-out errors of all laws without effects. The held-out RMS of the further law
    must be smaller by the factor `margin`.
    """
    alone = {t.law: t.held_out_rms for t in laws}
    first, last = best.steps[0], best.steps[-1]
    improved = last.held_out_rms / max(first.held_out_rms, 1e-300)
    return alone[law] < alone[best.model.law] * improved / margin


def replaces(
    further: Diagnosis, best: Diagnosis, recorded: Campaign, margin: float, *, simplest: bool
) -> bool:
    """Whether the diagnosis with a further law replaces the best one so far.

    Its held-out RMS must be smaller by the factor `margin`. If the further law is the `simplest`
    one, the RMS may be larger by this factor, but there must not be more effects, or residual
    structure in addition.
    """
    before, after = held_out_rms_of_diagnoses((best, further), recorded)
    if not simplest:
        return after < before / margin
    more_effects = len(further.model.effects) > len(best.model.effects)
    more_structure = bool(further.residual_structure) and not best.residual_structure
    return after < before * margin and not more_effects and not more_structure


def held_out_rms_of_diagnoses(diagnoses: Sequence[Diagnosis], recorded: Campaign) -> list[float]:
    """Held-out RMS of the final models of several diagnoses on common samples, unit of the force.

    It is computed as the fit RMS on these samples, times the ratio of held-out RMS to fit RMS. The
    force of each run is corrected for the delay of each diagnosis.
    """
    runs = [p.run.name for p in recorded.prepared]
    delays_s = [delays_by_run_s(runs, diagnosis.fit.findings) for diagnosis in diagnoses]
    margin_s = max(abs(delay_s) for of_runs_s in delays_s for delay_s in of_runs_s.tolist())
    compared = [
        compare_prepared(diagnosis.model, aligned(recorded, of_runs_s, margin_s))
        for diagnosis, of_runs_s in zip(diagnoses, delays_s, strict=True)
    ]
    samples = compared[0].samples
    for comparison in compared:
        samples = samples.within(comparison.samples.counted)
    final_steps = [diagnosis.steps[-1] for diagnosis in diagnoses]
    return [
        samples.rms(comparison.residuals) * step.held_out_rms / max(step.rms, 1e-300)
        for comparison, step in zip(compared, final_steps, strict=True)
    ]
