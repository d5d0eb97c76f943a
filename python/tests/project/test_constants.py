"""Numbers that influence a verdict are fields of the policy, and nowhere else."""

import ast
import runpy
from collections.abc import Iterator
from pathlib import Path

import jbf
import pytest
from jbf.diagnosis.policy import DEFAULT
from jbf.errors import InputError

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "python" / "jbf"
POLICY = {"diagnosis.policy_sections", "diagnosis.policy_residual", "estimation.settings"}

NUMERICAL = {
    "reported next to the verdict or used after it: power, proposals, checks, final fit": """
        estimation.solution: MIN_SAMPLES
        diagnosis.power.distinction: NEVER MOST FURTHER
        diagnosis.check: SURE
        diagnosis.directions: DECOY_DRAWS SURE
        estimation.identifiability: MAX_DEVIANCE_INCREASE
        diagnosis.experiment_design.excitations: MOST_SAMPLES RATES_RAD_S SHARES STOP_SHARES REST_S
        diagnosis.experiment_design.excitations: USUAL_RATE_RAD_S REACH
        diagnosis.experiment_design.next_run: LEAST_SAMPLES
        diagnosis.experiment_design.plan: ENOUGH MORE
        diagnosis.power.detection_limits: LEVELS NEARLY_ALL BEYOND
        diagnosis.power.strength: DRAWS
        estimation.delay_scan: LEAST_STEPS CLIPPED BLURRED
        estimation.minimum: HUBER_TUNING STUDENT_FREEDOM MIN_CHANGE BETTER_RMS EQUAL_RMS
        estimation.minimum: BETTER_MEDIAN
        estimation.standard_errors: BENT
        estimation.trajectory_fit: REST_SHARE
    """,
    "text of a result": """
        diagnosis.budget: EVALUATIONS USUAL_CANDIDATES USUAL_STEPS CANDIDATES_A_LAW STEPS_A_SECOND
        diagnosis.budget: STAGES
        diagnosis.residual_structure.bursts: APART_S NAMED
        diagnosis.residual_structure.constancy: NAMED MOST_REPORTED
        diagnosis.selection: LESS
        estimation.identifiability: ONE_SIDED
    """,
    "tolerance of a numerical comparison or of an iteration": """
        diagnosis.residual_structure.bursts: NO_NOISE
        diagnosis.power.detection_limits: AGREES
        diagnosis.experiment_design.next_run: NO_NOISE
        diagnosis.terms.shifts: SETTLED
        estimation.bounds: AT_BOUND
        estimation.delays: RANK
        estimation.delayed_fits: SETTLED DELAY_TOLERANCE SETTLED_DELAY
        estimation.held_out: SHORT STRAIGHT STEP_DAMPING NOTHING
        estimation.identifiability: SAME_IN_FRICTION
        estimation.least_squares: INDEPENDENT
        estimation.posterior_motions: EXACT_RECORD RATIO_STEP
        estimation.problem: BOUNDLESS
        estimation.random_effects: ROUNDING
        estimation.levenberg_marquardt: MAX_DAMPING TRUSTED ACCURATE
        estimation.search: NEAR SAME ENDED NEAR_MINIMUM
        estimation.standard_errors: INSENSITIVE SINGULAR TAKES_PART
        estimation.starting_values: SHORTEST_M
    """,
    "limits computing time or memory; an exceeded budget is reported": """
        diagnosis.candidates: RANKING_EVALUATIONS
        diagnosis.power.detection_limits: MOST_STRENGTHS MOST_ITERATIONS
        diagnosis.power.strength: CACHED_SAMPLES
        diagnosis.terms.proposal: EVALUATIONS
        estimation.parallel_fits: MOST_AT_ONCE MAX_PARALLEL_SAMPLES
        diagnosis.terms.quantiser: EVALUATIONS MOST_ITERATIONS
        diagnosis.terms.shifts: EVALUATIONS STEPS
        estimation.delayed_fits: ROUNDS EVALUATIONS MAX_DELAY_ITERATIONS
        estimation.held_out: EVALUATIONS
        estimation.least_squares: MOST_HELD SEARCHED LEAST_RUNS GROUP BLOCK
        estimation.approach: TRIAL_EVALUATIONS FOLLOWED KEPT LOOKED
        estimation.minimum: MAX_EVALUATIONS FOLLOWED_IN_A_FIT NESTED_EVALUATIONS ROBUST_ROUNDS
        estimation.levenberg_marquardt: RESIDUALS_COST
        estimation.problem: SLOPES_COST
        estimation.search: CLIMBED
        estimation.transients: RANKING_EVALUATIONS
        estimation.work: STEPS_A_SAMPLE ANY_STEPS
    """,
    "rejects impossible input": """
        diagnosis.experiment_design.excitations: MOST LONGEST_S
        diagnosis.experiment_design.plan: LEAST_RUNS MOST_RUNS
        estimation.bootstrap: LEAST_REPEATS MOST_REPEATS
    """,
    "resolution of a grid, a derivative or a number of draws": """
        diagnosis.level: DRAWS
        diagnosis.power.strength: STRENGTH_RATIO
        diagnosis.residual_structure.periodic: MOST_BINS PADDING
        estimation.delays: FINE_S
        estimation.delay_scan: COARSE FINE
        estimation.delayed_fits: DELAY_SPAN
        estimation.generalised_least_squares: INTENSITY_STEP
        estimation.posterior_motions: STEP
        estimation.identifiability: SHARES
        estimation.pitches: MOST_BINS PADDING
        estimation.prepared: FINER
        estimation.quantisation: HARMONICS
        estimation.search: POINTS
        estimation.transients: EDGE
    """,
    "range of a search, wider than any plausible result": """
        diagnosis.power.detection_limits: EXPONENTS
        estimation.delay_scan: REACH LEAST_REACH_STEPS
        estimation.delayed_fits: MAX_DELAY_CHANGE
        estimation.generalised_least_squares: LEAST_INTENSITY
        estimation.posterior_motions: LEAST_NOISE MOST_NOISE MOST_SCALE RATIOS
        estimation.quantisation: MOST_NOISE
        estimation.search: REACH
    """,
    "property of a distribution or an estimator, no choice": """
        diagnosis.terms.noise_variance: ERROR
        estimation.campaign: NOISE_SPAN
        estimation.uncertain_samples: MOST
    """,
    "path or starting values of searches": """
        estimation.levenberg_marquardt: INITIAL_DAMPING LEAST_FACTOR FIRST_INCREASE
        estimation.levenberg_marquardt: ACCEPTED
        estimation.search: LONGEST
        diagnosis.terms.noise_variance: START_FREEDOM
        estimation.campaign: HUM
        estimation.pitches: LINES BINS_A_PITCH KNOTS
        estimation.starting_values: CELL_ERROR RULES LINEAR_RULES CAMPAIGN_RULES
    """,
    "definition of an effect": """
        estimation.starting_values: BEYOND MAX_CELL_HYSTERESIS
    """,
}
"""Constants outside the policy: why they decide nothing, and their names by module."""
COMPARED = {
    ("estimation.uncertain_samples", 3.0),  # three values have a second difference
    ("estimation.trajectory_fit", 1e6),  # a fit of simulated motions enters no verdict
}
"""Numbers other than 0, 1, 2 and a half in comparisons."""


def _modules() -> Iterator[tuple[str, ast.Module]]:
    for package in ("diagnosis", "estimation"):
        for file in sorted((PACKAGE / package).rglob("*.py")):
            name = ".".join(file.relative_to(PACKAGE).with_suffix("").parts)
            if name not in POLICY:
                yield name, ast.parse(file.read_text())


def _numbers(node: ast.AST) -> list[float]:
    return [
        float(n.value)
        for n in ast.walk(node)
        if isinstance(n, ast.Constant) and type(n.value) in (int, float)
    ]


def _constants(tree: ast.Module) -> Iterator[str]:
    """Module-level names in capitals whose value contains a number."""
    for node in tree.body:
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.value and _numbers(node.value):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names = (
                n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)
            )
            yield from (name for name in names if name.isupper())


def test_no_number_outside_the_policy_influences_a_verdict() -> None:
    listed = {
        f"{module.strip()}.{name}"
        for lines in NUMERICAL.values()
        for module, names in (line.split(":") for line in lines.strip().splitlines())
        for name in names.split()
    }
    found = {f"{module}.{name}" for module, tree in _modules() for name in _constants(tree)}
    assert found - listed == set(), "make it a field of the policy, or list it with its reason"
    assert listed - found == set(), "remove it from the list"


def test_comparisons_contain_no_number_that_is_not_listed() -> None:
    found = {
        (module, abs(number))
        for module, tree in _modules()
        for node in ast.walk(tree)
        if isinstance(node, ast.Compare)
        for side in (node.left, *node.comparators)
        if isinstance(side, ast.Constant | ast.UnaryOp)
        for number in _numbers(side)
    }
    assert {(m, n) for m, n in found if n not in (0.0, 0.5, 1.0, 2.0)} == COMPARED


def test_every_number_of_the_policy_states_what_it_decides_and_its_source() -> None:
    explained = jbf.Policy.explained()
    assert explained.keys() == DEFAULT.to_dict().keys()
    assert all(decides and source for _, decides, source in explained.values())


def test_every_number_of_the_policy_is_read_by_a_module() -> None:
    read = {
        n.attr for _, tree in _modules() for n in ast.walk(tree) if isinstance(n, ast.Attribute)
    }
    assert {name for name in DEFAULT.to_dict() if name.split(".")[-1] not in read} == set()


def test_policy_with_other_values_keeps_the_rest() -> None:
    changed = DEFAULT.with_values({"terms.chance": 1e-3, "estimation.variance.min_runs": 4})
    assert changed.terms.chance == 1e-3
    assert changed.estimation.variance.min_runs == 4
    before, after = DEFAULT.to_dict(), changed.to_dict()
    assert {k for k in before if before[k] != after[k]} == {
        "terms.chance",
        "estimation.variance.min_runs",
    }
    with pytest.raises(InputError, match=r"no value terms\.odds"):
        DEFAULT.with_values({"terms.odds": 1.0})


def test_table_of_the_policy_is_up_to_date() -> None:
    written = runpy.run_path(str(ROOT / "docs" / "policy.py"))
    assert written["page"]() == written["PAGE"].read_text(), "run docs/policy.py"
