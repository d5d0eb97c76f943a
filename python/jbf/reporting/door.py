"""Entry point from results to their text, figures, tables and pages (used by `jbf.results`).

One function per operation, dispatched on the type of the result.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch
from typing import TYPE_CHECKING

from jbf.comparison.comparison import Comparison
from jbf.control.run import Result as LoopRun
from jbf.diagnosis.check import Check
from jbf.diagnosis.plan import Plan
from jbf.diagnosis.planned import PlannedPower
from jbf.diagnosis.result import Diagnosis
from jbf.estimation.bootstrap import Bootstrap
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.importing.result import Import
from jbf.models.model import Model
from jbf.records.run import Run
from jbf.reporting import frames, import_text, short, small_tables
from jbf.reporting.check_text import check_report, short_check
from jbf.reporting.comparison_text import comparison_report
from jbf.reporting.control_run_text import runs_text
from jbf.reporting.diagnosis_text import diagnosis_report
from jbf.reporting.fit_text import bootstrap_report, fit_report, trajectory_report
from jbf.reporting.power_text import plan_report, planned_report, short_plan, short_power

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@singledispatch
def summary(result: object) -> str:
    """Return the report of a result as text for a terminal."""
    raise TypeError(f"reporting knows no result of type {type(result).__name__}")


summary.register(Fit, fit_report)
summary.register(Bootstrap, bootstrap_report)
summary.register(TrajectoryFit, trajectory_report)
summary.register(Comparison, comparison_report)
summary.register(Diagnosis, diagnosis_report)
summary.register(LoopRun, lambda run: runs_text([run]))
summary.register(Import, import_text.import_report)
summary.register(PlannedPower, planned_report)
summary.register(Check, check_report)
summary.register(Plan, plan_report)


@singledispatch
def short_words(result: object) -> str:
    """Summarize a result in one or two lines."""
    return object.__repr__(result)


short_words.register(Fit, short.short_fit)
short_words.register(Bootstrap, short.short_bootstrap)
short_words.register(TrajectoryFit, short.short_trajectory_fit)
short_words.register(Comparison, short.short_comparison)
short_words.register(Diagnosis, short.short_diagnosis)
short_words.register(Import, import_text.short_import)
short_words.register(PlannedPower, short_power)
short_words.register(Check, short_check)
short_words.register(Plan, short_plan)


@singledispatch
def small_table(result: object) -> str:
    """Return a result as a small HTML table."""
    raise TypeError(f"reporting knows no result of type {type(result).__name__}")


small_table.register(Fit, small_tables.fit_table)
small_table.register(Bootstrap, small_tables.bootstrap_table)
small_table.register(TrajectoryFit, small_tables.trajectory_table)
small_table.register(Comparison, small_tables.comparison_table)
small_table.register(Diagnosis, small_tables.diagnosis_table)
small_table.register(LoopRun, small_tables.loop_table)
small_table.register(Import, small_tables.import_table)
small_table.register(Model, small_tables.model_table)
small_table.register(Run, small_tables.run_table)
small_table.register(PlannedPower, small_tables.planned_table)
small_table.register(Plan, small_tables.plan_table)
small_table.register(Check, small_tables.check_table)


@singledispatch
def columns(result: object) -> frames.Columns:
    """Return a result as columns of equal length."""
    raise TypeError(f"reporting knows no result of type {type(result).__name__}")


columns.register(Fit, frames.fit_columns)
columns.register(Bootstrap, lambda found: dict(found.values))
columns.register(TrajectoryFit, frames.trajectory_columns)
columns.register(Comparison, frames.comparison_columns)
columns.register(Diagnosis, frames.diagnosis_columns)
columns.register(LoopRun, LoopRun.columns)
columns.register(Import, import_text.import_columns)


def plot(result: object, axes: Sequence[Axes] | None = None) -> Sequence[Axes]:
    """Plot a result."""
    # Imported here because matplotlib takes most of a second to import, and text output does not
    # need it.
    from jbf.reporting import pictures

    return pictures.plot(result, axes)


def page(result: object) -> str:
    """Return the HTML text of a result's page."""
    from jbf.reporting import pictures

    return pictures.page(result)
