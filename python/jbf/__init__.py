"""Friction that moves: models of dynamic friction, compared with measurements, completed by the
effect they lack, and cancelled in the loop.

>>> import jbf
>>> rig, runs = jbf.read_rig("rig.toml"), jbf.read_runs("runs/")   # doctest: +SKIP
>>> jbf.diagnose(rig, runs).verdict                                # doctest: +SKIP
'missing'
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from jbf._core import __version__
from jbf.batching import batch
from jbf.catalogue import Parameter, effects, laws
from jbf.errors import FilmWarning, InputError, JbfError
from jbf.model import Model
from jbf.model_file import ParameterValue
from jbf.own_effects import forget_effect, load_effects, register_effect
from jbf.record import Run, read_run, read_runs
from jbf.rig import Bearing, Load, Lubricant, Rig, read_rig
from jbf.trajectory import Trajectory, trajectories, trajectory

if TYPE_CHECKING:
    from jbf import control
    from jbf.bootstrapping import Bootstrap, bootstrap
    from jbf.comparison import Comparison, compare
    from jbf.diagnosis import Diagnosis, Experiment, Limits, diagnose, diagnose_many
    from jbf.fitting import Fit, fit
    from jbf.trajectory_fit import TrajectoryFit, fit_trajectories

# These need scipy, which takes most of a second to import: they come at first use, so that a
# prediction or `jbf effects` does not wait for them.
_LATER = {
    "Bootstrap": "jbf.bootstrapping",
    "bootstrap": "jbf.bootstrapping",
    "Comparison": "jbf.comparison",
    "compare": "jbf.comparison",
    "Diagnosis": "jbf.diagnosis",
    "Experiment": "jbf.diagnosis",
    "Limits": "jbf.diagnosis",
    "diagnose": "jbf.diagnosis",
    "diagnose_many": "jbf.diagnosis",
    "Fit": "jbf.fitting",
    "fit": "jbf.fitting",
    "TrajectoryFit": "jbf.trajectory_fit",
    "fit_trajectories": "jbf.trajectory_fit",
}

__all__ = [
    "Bearing",
    "Bootstrap",
    "Comparison",
    "Diagnosis",
    "Experiment",
    "FilmWarning",
    "Fit",
    "InputError",
    "JbfError",
    "Limits",
    "Load",
    "Lubricant",
    "Model",
    "Parameter",
    "ParameterValue",
    "Rig",
    "Run",
    "Trajectory",
    "TrajectoryFit",
    "__version__",
    "batch",
    "bootstrap",
    "compare",
    "control",
    "diagnose",
    "diagnose_many",
    "effects",
    "fit",
    "fit_trajectories",
    "forget_effect",
    "laws",
    "load_effects",
    "read_rig",
    "read_run",
    "read_runs",
    "register_effect",
    "trajectories",
    "trajectory",
]


def __getattr__(name: str) -> Any:
    if name == "control":
        return import_module("jbf.control")
    if name not in _LATER:
        raise AttributeError(f"module 'jbf' has no attribute {name!r}")
    value = getattr(import_module(_LATER[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
