"""Self-contained HTML pages that consist of the text of a result and its figure."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes

from jbf.comparison.model_comparison import ModelComparison
from jbf.control.run import Result as LoopRun
from jbf.diagnosis.check import Check
from jbf.diagnosis.experiment_design.plan import Plan
from jbf.diagnosis.power.planned_runs import PlannedPower
from jbf.errors import InputError
from jbf.estimation.bootstrap import Bootstrap
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.reporting.check_text import check_report
from jbf.reporting.comparison_plots import plot_model_comparison
from jbf.reporting.comparison_text import model_comparison_report
from jbf.reporting.control_run_plot import plot_run_of_loop
from jbf.reporting.control_run_text import runs_text
from jbf.reporting.fit_plot import plot_bootstrap, plot_fit, plot_trajectory_fit
from jbf.reporting.fit_text import bootstrap_report, fit_report, trajectory_report
from jbf.reporting.page import page
from jbf.reporting.power_text import plan_report, planned_report
from jbf.reporting.study_plots import plot_check, plot_planned_power
from jbf.reporting.svg import svg


def _page(title: str, words: str, axes: Sequence[Axes], alt: str) -> str:
    picture = svg(axes, alt) if axes else ""
    return page("text.html.j2", title, words=words, picture=picture)


def fit_page(fit: Fit) -> str:
    """HTML page of a fit."""
    alt = "Parameters with standard errors; residuals of all runs in sequence"
    return _page("Fit", fit_report(fit), plot_fit(fit), alt)


def bootstrap_page(bootstrap: Bootstrap) -> str:
    """HTML page of a bootstrap."""
    alt = "Parameters with estimates from repeated fits"
    words = bootstrap_report(bootstrap)
    return _page("Fit with bootstrap standard errors", words, plot_bootstrap(bootstrap), alt)


def trajectory_page(fit: TrajectoryFit) -> str:
    """HTML page of a trajectory fit."""
    alt = "Parameters with standard errors"
    return _page("Fit of trajectories", trajectory_report(fit), plot_trajectory_fit(fit), alt)


def loop_page(run: LoopRun) -> str:
    """HTML page of one control-loop run."""
    alt = "Response, error, friction and learned parameters"
    return _page(f"Loop: {run.scheme}", runs_text([run]), plot_run_of_loop(run), alt)


def model_comparison_page(compared: ModelComparison) -> str:
    """HTML page of a comparison of models."""
    alt = "Difference of each model to the best, with its standard error"
    words = model_comparison_report(compared)
    return _page("Comparison of models", words, plot_model_comparison(compared), alt)


def planned_power_page(planned: PlannedPower) -> str:
    """HTML page of the detection limits of planned runs."""
    words = planned_report(planned)
    return _page("Power of planned runs", words, _power_axes(planned), "Probability of detection")


def plan_page(plan: Plan) -> str:
    """HTML page of a plan."""
    axes = _power_axes(plan.planned)
    return _page("Plan", plan_report(plan), axes, "Probability of detection")


def _power_axes(planned: PlannedPower) -> list[Axes]:
    """Axes with the power curves of planned runs; empty if no effect has a curve."""
    try:
        return plot_planned_power(planned)
    except InputError:
        return []


def check_page(check: Check) -> str:
    """HTML page of the simulated success rates of a diagnosis."""
    return _page("Check", check_report(check), plot_check(check), "Rates with their intervals")
