"""Identification, diagnosis and compensation of dynamic friction.

Models of friction are compared with measurements, completed by missing effects, and used for
compensation in control loops.

>>> import jbf
>>> rig, runs = jbf.read_rig("rig.toml"), jbf.read_runs("runs/")   # doctest: +SKIP
>>> jbf.diagnose(rig, runs).verdict                                # doctest: +SKIP
'missing'
"""

from importlib import import_module as _import_module
from typing import TYPE_CHECKING as _TYPE_CHECKING

from jbf import cores as _cores
from jbf import results as _results
from jbf._core import __version__
from jbf.errors import FilmWarning, InputError, JbfError, Stopped, Unfinished

if _TYPE_CHECKING:
    from jbf import control, export, plot
    from jbf.comparison.compare import compare
    from jbf.comparison.comparison import Comparison
    from jbf.comparison.model_comparison import ModelComparison
    from jbf.diagnosis import Diagnosis, Experiment, Limits, Policy, diagnose, diagnose_many
    from jbf.diagnosis.check import Check, check
    from jbf.diagnosis.experiment_design.plan import Plan, plan
    from jbf.diagnosis.power.planned_runs import PlannedPower, planned_power
    from jbf.estimation.bootstrap import Bootstrap, bootstrap
    from jbf.estimation.fit import Fit, fit
    from jbf.estimation.trajectory_fit import TrajectoryFit, fit_trajectories
    from jbf.estimation.work import TimeLimit
    from jbf.importing.guessed import Guess
    from jbf.importing.import_files import import_files, look, read_recording
    from jbf.importing.mapping import Map, read_map
    from jbf.importing.result import Import
    from jbf.models.batch import batch
    from jbf.models.catalogue import Parameter, effects, laws
    from jbf.models.model import Model
    from jbf.models.parameter_value import ParameterValue
    from jbf.models.trajectory import Trajectory, trajectories, trajectory
    from jbf.models.user_effects import forget_effect, load_effects, register_effect
    from jbf.models.user_laws import forget_law, register_law
    from jbf.records.csv_file import read_run
    from jbf.records.drive import Drive
    from jbf.records.rig import Bearing, Load, Lubricant, Rig, read_rig
    from jbf.records.run import Run
    from jbf.records.run_files import read_runs

_cores.cap_threads()
_results.presented_by(
    "jbf.reporting.presenters", "summary", "short_words", "small_table", "columns"
)
_results.presented_by("jbf.reporting.pictures", "plot", "page")

# All names are imported lazily, at first access. The import of numpy takes about 0.1 s and that of
# scipy nearly 1 s; `jbf --help` needs neither, and a prediction does not need scipy.
_LATER = {
    "batch": "jbf.models.batch",
    "Parameter": "jbf.models.catalogue",
    "effects": "jbf.models.catalogue",
    "laws": "jbf.models.catalogue",
    "Model": "jbf.models.model",
    "forget_effect": "jbf.models.user_effects",
    "load_effects": "jbf.models.user_effects",
    "register_effect": "jbf.models.user_effects",
    "forget_law": "jbf.models.user_laws",
    "register_law": "jbf.models.user_laws",
    "ParameterValue": "jbf.models.parameter_value",
    "Trajectory": "jbf.models.trajectory",
    "trajectories": "jbf.models.trajectory",
    "trajectory": "jbf.models.trajectory",
    "read_run": "jbf.records.csv_file",
    "Drive": "jbf.records.drive",
    "Bearing": "jbf.records.rig",
    "Load": "jbf.records.rig",
    "Lubricant": "jbf.records.rig",
    "Rig": "jbf.records.rig",
    "read_rig": "jbf.records.rig",
    "Run": "jbf.records.run",
    "read_runs": "jbf.records.run_files",
    "Bootstrap": "jbf.estimation.bootstrap",
    "bootstrap": "jbf.estimation.bootstrap",
    "Comparison": "jbf.comparison.comparison",
    "ModelComparison": "jbf.comparison.model_comparison",
    "compare": "jbf.comparison.compare",
    "Diagnosis": "jbf.diagnosis",
    "Experiment": "jbf.diagnosis",
    "Limits": "jbf.diagnosis",
    "diagnose": "jbf.diagnosis",
    "diagnose_many": "jbf.diagnosis",
    "Check": "jbf.diagnosis.check",
    "check": "jbf.diagnosis.check",
    "Plan": "jbf.diagnosis.experiment_design.plan",
    "plan": "jbf.diagnosis.experiment_design.plan",
    "Policy": "jbf.diagnosis",
    "PlannedPower": "jbf.diagnosis.power.planned_runs",
    "planned_power": "jbf.diagnosis.power.planned_runs",
    "Fit": "jbf.estimation.fit",
    "fit": "jbf.estimation.fit",
    "TrajectoryFit": "jbf.estimation.trajectory_fit",
    "fit_trajectories": "jbf.estimation.trajectory_fit",
    "TimeLimit": "jbf.estimation.work",
    "Guess": "jbf.importing.guessed",
    "Import": "jbf.importing.result",
    "Map": "jbf.importing.mapping",
    "import_files": "jbf.importing.import_files",
    "look": "jbf.importing.import_files",
    "read_map": "jbf.importing.mapping",
    "read_recording": "jbf.importing.import_files",
}

_PACKAGES = ("control", "export", "plot")

__all__ = [
    "Bearing",
    "Bootstrap",
    "Check",
    "Comparison",
    "Diagnosis",
    "Drive",
    "Experiment",
    "FilmWarning",
    "Fit",
    "Guess",
    "Import",
    "InputError",
    "JbfError",
    "Limits",
    "Load",
    "Lubricant",
    "Map",
    "Model",
    "ModelComparison",
    "Parameter",
    "ParameterValue",
    "Plan",
    "PlannedPower",
    "Policy",
    "Rig",
    "Run",
    "Stopped",
    "TimeLimit",
    "Trajectory",
    "TrajectoryFit",
    "Unfinished",
    "__version__",
    "batch",
    "bootstrap",
    "check",
    "compare",
    "control",
    "diagnose",
    "diagnose_many",
    "effects",
    "export",
    "fit",
    "fit_trajectories",
    "forget_effect",
    "forget_law",
    "import_files",
    "laws",
    "load_effects",
    "look",
    "plan",
    "planned_power",
    "plot",
    "read_map",
    "read_recording",
    "read_rig",
    "read_run",
    "read_runs",
    "register_effect",
    "register_law",
    "trajectories",
    "trajectory",
]


def __getattr__(name: str) -> object:
    if name in _PACKAGES:
        return _import_module(f"jbf.{name}")
    if name not in _LATER:
        raise AttributeError(f"module 'jbf' has no attribute {name!r}")
    value = getattr(_import_module(_LATER[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
