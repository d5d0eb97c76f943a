"""Short texts of results for `repr`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from jbf.comparison.comparison import Comparison
from jbf.comparison.model_comparison import ModelComparison
from jbf.diagnosis.result import Diagnosis
from jbf.estimation.bootstrap import Bootstrap
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.models.model import Model
from jbf.models.parameter_value import ParameterValue
from jbf.records.counts import count_of
from jbf.reporting.words import against_noise, number, value_and_error

LONGEST = 120
"""Maximum length in characters of a list that grows with the model.

A line contains at most two such lists.
"""


def first_of(items: Iterable[str], join: str = ", ") -> str:
    """Join items, and replace those beyond the maximum length by an ellipsis."""
    listed_items = list(items)
    joined = join.join(listed_items)
    while len(joined) > LONGEST and listed_items:
        listed_items.pop()
        joined = join.join([*listed_items, "..."])
    return joined


def _values(parameters: Mapping[str, ParameterValue]) -> str:
    def described(name: str, p: ParameterValue) -> str:
        value, error = value_and_error(p)
        return f"{name} {value} +/- {error}" if error else f"{name} {value}"

    return first_of(described(name, p) for name, p in parameters.items())


def _fitted(fit: Fit) -> str:
    return _values(fit.parameters)


def _law(model: Model) -> str:
    return first_of([model.law, *model.effects], " + ")


def short_fit(fit: Fit) -> str:
    """Summarize a fit: model, runs and RMS, with the parameters on a second line."""
    search = "" if fit.converged else ", not converged"
    unit = fit.model.rig.quantities.force
    return (
        f"Fit({_law(fit.model)}; {count_of(len(fit.residuals), 'run')}, "
        f"{count_of(fit.nobs, 'sample')}, "
        f"RMS {number(fit.rms)} {unit}{search};\n    {_fitted(fit)})"
    )


def short_bootstrap(bootstrap: Bootstrap) -> str:
    """Summarize a bootstrap: number of repeats, and parameters with bootstrap standard errors."""
    repeats = len(next(iter(bootstrap.values.values())))
    return f"Bootstrap({count_of(repeats, 'fit')};\n    {_fitted(bootstrap.fit)})"


def short_trajectory_fit(fit: TrajectoryFit) -> str:
    """Summarize a trajectory fit: number of samples, and parameters."""
    search = "" if fit.converged else ", not converged"
    return f"TrajectoryFit({count_of(fit.nobs, 'sample')}{search};\n    {_values(fit.parameters)})"


def short_comparison(comparison: Comparison) -> str:
    """Summarize a comparison: error, and axes along which the model fails."""
    where = first_of(f.axis for f in comparison.failures)
    rms, noise = comparison.rms, comparison.noise_rms
    unit = comparison.model.rig.quantities.force
    return (
        f"Comparison({_law(comparison.model)}; {count_of(len(comparison.runs), 'run')}, "
        f"RMS {number(rms)} {unit}, {against_noise(rms, noise, unit)};\n    "
        + (f"lack of fit along {where})" if where else "no lack of fit along any axis)")
    )


def short_model_comparison(compared: ModelComparison) -> str:
    """Summarize a comparison of models: RMS of each model, the smallest first."""
    errors = first_of(f"{m.name} {number(m.rms)}" for m in compared.models)
    return (
        f"ModelComparison({count_of(compared.nobs, 'sample')};\n"
        f"    RMS ({compared.force_unit}): {errors})"
    )


def short_diagnosis(diagnosis: Diagnosis) -> str:
    """Summarize a diagnosis: verdict, effects, and held-out RMS of the final model."""
    last = diagnosis.steps[-1]
    unit = diagnosis.model.rig.quantities.force
    effects = first_of(diagnosis.effects)
    added = f": {effects}" if effects else ""
    return (
        f"Diagnosis({diagnosis.verdict}{added};\n    held out {number(last.held_out_rms)} {unit}, "
        f"{against_noise(last.held_out_rms, last.noise_rms, unit)})"
    )
