"""Friction that moves: models of dynamic friction, compared with measurements, completed by the
effect they lack, and cancelled in the loop.

>>> import jbf
>>> rig, runs = jbf.read_rig("rig.toml"), jbf.read_runs("runs/")   # doctest: +SKIP
>>> jbf.diagnose(rig, runs).verdict                                # doctest: +SKIP
'missing'
"""

from jbf._core import __version__
from jbf.catalogue import effects, laws
from jbf.comparison import Comparison, compare
from jbf.diagnosis import Diagnosis, diagnose
from jbf.errors import InputError, JbfError
from jbf.fitting import Fit, fit
from jbf.model import Model
from jbf.model_file import ParameterValue
from jbf.record import Run, read_run, read_runs
from jbf.rig import Bearing, Load, Lubricant, Rig, read_rig

__all__ = [
    "Bearing",
    "Comparison",
    "Diagnosis",
    "Fit",
    "InputError",
    "JbfError",
    "Load",
    "Lubricant",
    "Model",
    "ParameterValue",
    "Rig",
    "Run",
    "__version__",
    "compare",
    "diagnose",
    "effects",
    "fit",
    "laws",
    "read_rig",
    "read_run",
    "read_runs",
]
