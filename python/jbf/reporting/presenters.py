"""Presenters of results as text, small tables and columns, registered with `jbf.results`.

Those that need matplotlib are in `pictures`.
"""

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
from jbf.export.target import Exported
from jbf.importing.result import Import
from jbf.models.model import Model
from jbf.records.run import Run
from jbf.reporting import frames, import_text, short, small_tables
from jbf.reporting.check_text import check_report, short_check
from jbf.reporting.comparison_text import comparison_report, model_comparison_report
from jbf.reporting.control_run_text import runs_text
from jbf.reporting.diagnosis_text import diagnosis_text
from jbf.reporting.export_text import export_columns, export_report, export_table, short_export
from jbf.reporting.fit_text import bootstrap_report, fit_report, trajectory_report
from jbf.reporting.power_text import plan_report, planned_report, short_plan, short_power
from jbf.results import register

register("summary", Fit, fit_report)
register("summary", Bootstrap, bootstrap_report)
register("summary", TrajectoryFit, trajectory_report)
register("summary", Comparison, comparison_report)
register("summary", ModelComparison, model_comparison_report)
register("summary", Diagnosis, diagnosis_text)
register("summary", LoopRun, lambda run: runs_text([run]))
register("summary", Import, import_text.import_report)
register("summary", PlannedPower, planned_report)
register("summary", Check, check_report)
register("summary", Plan, plan_report)
register("summary", Exported, export_report)

register("short_words", Fit, short.short_fit)
register("short_words", Bootstrap, short.short_bootstrap)
register("short_words", TrajectoryFit, short.short_trajectory_fit)
register("short_words", Comparison, short.short_comparison)
register("short_words", ModelComparison, short.short_model_comparison)
register("short_words", Diagnosis, short.short_diagnosis)
register("short_words", Import, import_text.short_import)
register("short_words", PlannedPower, short_power)
register("short_words", Check, short_check)
register("short_words", Plan, short_plan)
register("short_words", Exported, short_export)

register("small_table", Fit, small_tables.fit_table)
register("small_table", Bootstrap, small_tables.bootstrap_table)
register("small_table", TrajectoryFit, small_tables.trajectory_table)
register("small_table", Comparison, small_tables.comparison_table)
register("small_table", ModelComparison, small_tables.model_comparison_table)
register("small_table", Diagnosis, small_tables.diagnosis_table)
register("small_table", LoopRun, small_tables.loop_table)
register("small_table", Import, small_tables.import_table)
register("small_table", Model, small_tables.model_table)
register("small_table", Run, small_tables.run_table)
register("small_table", PlannedPower, small_tables.planned_table)
register("small_table", Plan, small_tables.plan_table)
register("small_table", Check, small_tables.check_table)
register("small_table", Exported, export_table)

register("columns", Fit, frames.fit_columns)
register("columns", Bootstrap, lambda found: dict(found.values))
register("columns", TrajectoryFit, frames.trajectory_columns)
register("columns", Comparison, frames.comparison_columns)
register("columns", ModelComparison, frames.model_comparison_columns)
register("columns", Diagnosis, frames.diagnosis_columns)
register("columns", LoopRun, LoopRun.columns)
register("columns", Import, import_text.import_columns)
register("columns", PlannedPower, frames.power_columns)
register("columns", Plan, frames.plan_columns)
register("columns", Check, frames.check_columns)
register("columns", Exported, export_columns)
