"""Presenters of results as plots and pages, which require matplotlib; see `presenters`."""

from __future__ import annotations

from jbf.comparison.comparison import Comparison
from jbf.comparison.model_comparison import ModelComparison
from jbf.control.run import Result as LoopRun
from jbf.diagnosis.check import Check
from jbf.diagnosis.experiment_design.plan import Plan
from jbf.diagnosis.power.planned_runs import PlannedPower
from jbf.diagnosis.result import Diagnosis
from jbf.estimation.bootstrap import Bootstrap
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.importing.result import Import
from jbf.reporting import text_pages
from jbf.reporting.comparison_page import comparison_page
from jbf.reporting.comparison_plots import plot_comparison, plot_model_comparison
from jbf.reporting.control_run_plot import plot_run_of_loop
from jbf.reporting.cut_plot import import_page, plot_cut
from jbf.reporting.diagnosis_page import diagnosis_page
from jbf.reporting.diagnosis_plot import plot_diagnosis
from jbf.reporting.fit_plot import plot_bootstrap, plot_fit, plot_trajectory_fit
from jbf.reporting.study_plots import plot_check, plot_plan, plot_planned_power
from jbf.results import register

register("plot", Fit, plot_fit)
register("plot", Bootstrap, plot_bootstrap)
register("plot", TrajectoryFit, plot_trajectory_fit)
register("plot", Comparison, plot_comparison)
register("plot", ModelComparison, plot_model_comparison)
register("plot", Diagnosis, plot_diagnosis)
register("plot", LoopRun, plot_run_of_loop)
register("plot", Import, plot_cut)
register("plot", PlannedPower, plot_planned_power)
register("plot", Plan, plot_plan)
register("plot", Check, plot_check)

register("page", Fit, text_pages.fit_page)
register("page", Bootstrap, text_pages.bootstrap_page)
register("page", TrajectoryFit, text_pages.trajectory_page)
register("page", Comparison, comparison_page)
register("page", ModelComparison, text_pages.model_comparison_page)
register("page", Diagnosis, diagnosis_page)
register("page", LoopRun, text_pages.loop_page)
register("page", Import, import_page)
register("page", PlannedPower, text_pages.planned_power_page)
register("page", Plan, text_pages.plan_page)
register("page", Check, text_pages.check_page)
