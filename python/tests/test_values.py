"""What rooms hand on are values: nobody changes them, and what belongs together has one length."""

from __future__ import annotations

import ast
import inspect
from types import ModuleType
from typing import Any

import pytest
from jbf.comparison import axes, bins, comparison, over_speed, parts, patterns
from jbf.diagnosis import (
    alone,
    bursts,
    candidates,
    check,
    confirmation,
    constancy,
    converter_bias,
    decoys,
    deviations,
    evidence,
    excitations,
    experiment,
    late_channels,
    ledger,
    level,
    many,
    one_round,
    plan,
    planned,
    policy,
    power,
    reached,
    recipe,
    remainder,
    result,
    ripples,
    rounds,
    second_look,
    selection,
    separation,
    side_by_side,
    standing,
    strength,
    strokes,
    tones,
    uneven_noise,
    unseen,
    verdict,
    which_law,
)
from jbf.diagnosis import replicates as repeated
from jbf.estimation import (
    approach,
    between_runs,
    blocks,
    bootstrap,
    campaign,
    converter,
    curvature,
    determined,
    estimates,
    exact_delay,
    film_gaps,
    film_rate,
    fit,
    initial_state,
    joint_lateness,
    jumps,
    lateness,
    left_out,
    likelihood,
    long_run,
    minimum,
    noise,
    noise_at,
    noise_floor,
    peaks,
    pitches,
    predictive,
    prepared,
    problem,
    put_back,
    random_effect,
    replicates,
    reversals,
    rows,
    run_start,
    samples,
    scales,
    search,
    solution,
    spread,
    starts,
    stroke,
    trajectory_fit,
    uncertainty,
    weighting,
    wild_bootstrap,
    work,
)
from jbf.results import Result

COMPARISON = (axes, bins, comparison, over_speed, parts, patterns)
DIAGNOSIS = (
    alone,
    bursts,
    candidates,
    check,
    confirmation,
    constancy,
    converter_bias,
    decoys,
    deviations,
    evidence,
    excitations,
    experiment,
    late_channels,
    ledger,
    level,
    many,
    one_round,
    plan,
    planned,
    policy,
    power,
    reached,
    recipe,
    remainder,
    repeated,
    result,
    ripples,
    rounds,
    second_look,
    selection,
    separation,
    side_by_side,
    standing,
    strength,
    strokes,
    tones,
    uneven_noise,
    unseen,
    verdict,
    which_law,
)
ESTIMATION = (
    approach,
    between_runs,
    blocks,
    bootstrap,
    campaign,
    converter,
    curvature,
    determined,
    estimates,
    exact_delay,
    film_gaps,
    film_rate,
    fit,
    initial_state,
    joint_lateness,
    jumps,
    lateness,
    left_out,
    likelihood,
    long_run,
    minimum,
    noise,
    noise_at,
    noise_floor,
    peaks,
    pitches,
    predictive,
    prepared,
    problem,
    put_back,
    random_effect,
    replicates,
    reversals,
    rows,
    run_start,
    samples,
    scales,
    search,
    solution,
    spread,
    starts,
    stroke,
    trajectory_fit,
    uncertainty,
    weighting,
    wild_bootstrap,
    work,
)
MODULES = (*COMPARISON, *DIAGNOSIS, *ESTIMATION)
CHANGING = {"Fitted", "Reached", "Visited", "Work"}
"""Books that are kept while a campaign is fitted: of these there is one, and it fills."""
THEMSELVES = {
    "BetweenRuns",
    "Campaign",
    "Change",
    "Deviation",
    "Directions",
    "ExactDelay",
    "LatenessStep",
    "PutBack",
    "Samples",
    "SecondLook",
    "Solution",
    "Spread",
    "_Scan",
    "_Shifted",
}
"""What holds arrays of many samples."""


@pytest.mark.parametrize("module", MODULES, ids=lambda module: str(module.__name__))
def test_what_is_handed_on_cannot_be_changed(module: ModuleType) -> None:
    """A result that a caller changes would change under all that hold it."""
    for kind in vars(module).values():
        if inspect.isclass(kind) and kind.__module__ == module.__name__:
            held: Any = getattr(kind, "__dataclass_params__", None)
            assert held is None or held.frozen != (kind.__name__ in CHANGING), kind


@pytest.mark.parametrize("module", MODULES, ids=lambda module: str(module.__name__))
def test_what_holds_arrays_is_equal_to_itself_alone_and_a_result_is_shown_in_a_line(
    module: ModuleType,
) -> None:
    """Arrays of many samples are no answer to whether two are one, and no line of a terminal; what
    a fit left is a key, under which more is kept."""
    for name, kind in vars(module).items():
        if inspect.isclass(kind) and kind.__module__ == module.__name__:
            assert (kind.__eq__ is object.__eq__ and kind.__hash__ is object.__hash__) or (
                name not in THEMSELVES
            ), name
            if issubclass(kind, Result):
                assert "__repr__" not in vars(kind), name


@pytest.mark.parametrize("module", MODULES, ids=lambda module: str(module.__name__))
def test_what_belongs_together_has_one_length(module: ModuleType) -> None:
    """Runs and their samples go in step: one too few is a fault, and is not dropped in silence."""
    for node in ast.walk(ast.parse(inspect.getsource(module))):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "zip":
            (strict,) = [k.value for k in node.keywords if k.arg == "strict"]
            assert isinstance(strict, ast.Constant)
            assert strict.value is True, f"line {node.lineno}"


@pytest.mark.parametrize(
    ("function", "named"),
    [
        (approach.Approach, ("each", "stepped")),
        (approach.approach, ("followed", "steps", "method")),
        (bootstrap.bootstrap, ("repeats", "seed", "start", "progress")),
        (determined.undetermined, ("moved", "separate")),
        (determined.at_null, ("fixed",)),
        (fit.fit, ("law", "clock", "start", "fixed")),
        (left_out.left_out_rms, ("apart",)),
        (left_out.left_out_by_run, ("apart",)),
        (left_out.errors_by_run, ("apart", "counted")),
        (pitches.pitches, ("along",)),
        (
            trajectory_fit.fit_trajectories,
            ("start", "model", "clock", "tolerance", "eps", "phi_rad"),
        ),
    ],
    ids=lambda what: getattr(what, "__name__", ""),
)
def test_what_only_its_name_explains_is_given_by_name(
    function: Any, named: tuple[str, ...]
) -> None:
    """A `True` among other values says nothing to who reads the call."""
    given = inspect.signature(function).parameters.values()
    only = tuple(p.name for p in given if p.kind is inspect.Parameter.KEYWORD_ONLY)
    assert only == named


@pytest.mark.parametrize(
    ("function", "defaults"),
    [
        # Forty answers tell an error to a fifth.
        (bootstrap.bootstrap, {"repeats": 40, "seed": 0}),
        (fit.fit, {"effects": (), "law": "journal", "clock": "journal"}),
        (
            trajectory_fit.fit_trajectories,
            {"model": "journal", "clock": "journal", "tolerance": 1e-6},
        ),
    ],
    ids=lambda what: getattr(what, "__name__", ""),
)
def test_what_is_not_given_is_as_it_is_documented(function: Any, defaults: dict[str, Any]) -> None:
    given = inspect.signature(function).parameters.values()
    found = {p.name: p.default for p in given if p.default not in (None, inspect.Parameter.empty)}
    assert found == defaults
