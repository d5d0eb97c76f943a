"""Results in a line or two, for a prompt, a debugger, a log: `repr`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from jbf.comparison.comparison import Comparison
from jbf.diagnosis.result import Diagnosis
from jbf.estimation.bootstrap import Bootstrap
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.models.model import Model
from jbf.models.parameter_value import ParameterValue
from jbf.records.counts import count_of
from jbf.reporting.words import number, times, value_and_error

LONGEST = 120
"""Of a list that would grow with a model; a line has two of them at most."""


def first_of(items: Iterable[str], join: str = ", ") -> str:
    """Items in a row, with dots for those that would make it too long."""
    kept = list(items)
    whole = join.join(kept)
    while len(whole) > LONGEST and kept:
        kept.pop()
        whole = join.join([*kept, "..."])
    return whole


def _values(parameters: Mapping[str, ParameterValue]) -> str:
    def one(name: str, p: ParameterValue) -> str:
        value, error = value_and_error(p)
        return f"{name} {value} +/- {error}" if error else f"{name} {value}"

    return first_of(one(name, p) for name, p in parameters.items())


def _law(model: Model) -> str:
    return first_of([model.law, *model.effects], " + ")


def short_fit(fit: Fit) -> str:
    """Model, runs, RMS; below it the parameters."""
    search = "" if fit.converged else ", not converged"
    return (
        f"Fit({_law(fit.model)}; {count_of(len(fit.residuals), 'run')}, "
        f"{count_of(fit.samples, 'sample')}, "
        f"RMS {number(fit.rms_n)} N{search};\n    {_values(fit.parameters)})"
    )


def short_bootstrap(found: Bootstrap) -> str:
    """How many answers, and the parameters with the errors that they show."""
    repeats = len(next(iter(found.values.values())))
    return f"Bootstrap({count_of(repeats, 'fit')} again;\n    {_values(found.fit.parameters)})"


def short_trajectory_fit(fit: TrajectoryFit) -> str:
    """The parameters, and how many samples they are from."""
    search = "" if fit.converged else ", not converged"
    return (
        f"TrajectoryFit({count_of(fit.samples, 'sample')}{search};\n    {_values(fit.parameters)})"
    )


def short_comparison(comparison: Comparison) -> str:
    """How far, and along which axes it fails."""
    where = first_of(f.axis for f in comparison.failures)
    rms, noise = comparison.rms_n, comparison.noise_n
    return (
        f"Comparison({_law(comparison.model)}; {count_of(len(comparison.runs), 'run')}, "
        f"RMS {number(rms)} N, {times(rms, noise)} the noise of {number(noise)} N;\n    "
        + (f"fails along {where})" if where else "no pattern along any axis)")
    )


def short_diagnosis(diagnosis: Diagnosis) -> str:
    """Verdict, effects, and how far the final model is from runs left out."""
    last = diagnosis.steps[-1]
    effects = first_of(diagnosis.effects)
    added = f": {effects}" if effects else ""
    return (
        f"Diagnosis({diagnosis.verdict}{added};\n    held out {number(last.holdout_rms_n)} N, "
        f"{times(last.holdout_rms_n, last.noise_n)} the noise of {number(last.noise_n)} N)"
    )
