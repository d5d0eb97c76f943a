"""Results of a fit for each parameter: value with error, or the reason why it is held."""

from __future__ import annotations

from jbf.estimation.determined import HELD, STATED, undetermined
from jbf.estimation.problem import Problem
from jbf.estimation.put_back import PutBack
from jbf.estimation.spread import Array, Spread
from jbf.models.parameter_value import ParameterValue


def parameter_values(problem: Problem, found: PutBack, spread: Spread) -> dict[str, ParameterValue]:
    """Return values with standard errors by name; parameters that are not identifiable are held."""
    results = {}
    values = found.values.tolist()
    for i, (name, page) in enumerate(problem.parameters.items()):
        error, note = None, found.notes.get(name)
        if i not in problem.open:
            note = STATED if page.stated else HELD
        elif note is None:
            k = problem.open.index(i)
            error = spread.error(k)
            separate = bool(spread.separate[k])
            note = undetermined(page, values[i], error, separate=separate)
        results[name] = ParameterValue(values[i], None if note else error, note, note is not None)
    return results


def correlations(problem: Problem, parameters: dict[str, ParameterValue], spread: Spread) -> Array:
    """Correlations of the parameters that are not held, in their order, shape (k, k)."""
    kept = [k for k, i in enumerate(problem.open) if not parameters[problem.names[i]].held]
    among: Array = spread.correlation[kept][:, kept]
    return among
