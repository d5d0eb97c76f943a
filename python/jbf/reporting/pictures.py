"""Plot and page functions of the entry point `door`, which require matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch

from matplotlib.axes import Axes

from jbf.comparison.comparison import Comparison
from jbf.control.run import Result as LoopRun
from jbf.diagnosis.result import Diagnosis
from jbf.estimation.bootstrap import Bootstrap
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.importing.result import Import
from jbf.reporting import fit_page
from jbf.reporting.comparison_page import comparison_page
from jbf.reporting.comparison_plots import plot_comparison
from jbf.reporting.control_run_plot import plot_run_of_loop
from jbf.reporting.cut_plot import import_page, plot_cut
from jbf.reporting.diagnosis_page import diagnosis_page
from jbf.reporting.diagnosis_plot import plot_diagnosis
from jbf.reporting.fit_plot import plot_bootstrap, plot_fit, plot_trajectory_fit


@singledispatch
def plot(result: object, axes: Sequence[Axes] | None = None) -> Sequence[Axes]:
    """Plot a result on the given axes, or on those of a new figure."""
    raise TypeError(f"reporting knows no result of type {type(result).__name__}")


plot.register(Fit, plot_fit)
plot.register(Bootstrap, plot_bootstrap)
plot.register(TrajectoryFit, plot_trajectory_fit)
plot.register(Comparison, plot_comparison)
plot.register(Diagnosis, plot_diagnosis)
plot.register(LoopRun, plot_run_of_loop)
plot.register(Import, plot_cut)


@singledispatch
def page(result: object) -> str:
    """Return the HTML text of a result's page."""
    raise TypeError(f"reporting knows no result of type {type(result).__name__}")


page.register(Fit, fit_page.fit_page)
page.register(Bootstrap, fit_page.bootstrap_page)
page.register(TrajectoryFit, fit_page.trajectory_page)
page.register(Comparison, comparison_page)
page.register(Diagnosis, diagnosis_page)
page.register(LoopRun, fit_page.loop_page)
page.register(Import, import_page)
