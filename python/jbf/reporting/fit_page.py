"""Self-contained HTML pages of fits and control-loop runs, with text and figures."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes

from jbf.control.run import Result as LoopRun
from jbf.estimation.bootstrap import Bootstrap
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.reporting.control_run_plot import plot_run_of_loop
from jbf.reporting.control_run_text import runs_text
from jbf.reporting.fit_plot import plot_bootstrap, plot_fit, plot_trajectory_fit
from jbf.reporting.fit_text import bootstrap_report, fit_report, trajectory_report
from jbf.reporting.page import page
from jbf.reporting.svg import svg


def _page(title: str, words: str, axes: Sequence[Axes], alt: str) -> str:
    return page("text.html.j2", title, words=words, picture=svg(axes, alt))


def fit_page(fit: Fit) -> str:
    """Return the HTML text of a fit's page."""
    alt = "Parameters with standard errors; residuals run after run"
    return _page("Fit", fit_report(fit), plot_fit(fit), alt)


def bootstrap_page(found: Bootstrap) -> str:
    """Return the HTML text of a bootstrap's page."""
    alt = "Parameters, and the answers of repeated fits"
    words = bootstrap_report(found)
    return _page("Fit, with errors from fits again", words, plot_bootstrap(found), alt)


def trajectory_page(fit: TrajectoryFit) -> str:
    """Return the HTML text of the page of a trajectory fit."""
    alt = "Parameters with standard errors"
    return _page("Fit of trajectories", trajectory_report(fit), plot_trajectory_fit(fit), alt)


def loop_page(run: LoopRun) -> str:
    """Return the HTML text of the page of one control-loop run."""
    alt = "Response, error, friction and what was learned"
    return _page(f"Loop: {run.scheme}", runs_text([run]), plot_run_of_loop(run), alt)
