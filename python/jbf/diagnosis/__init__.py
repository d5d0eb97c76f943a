"""Which physical effect is missing from a model, and when nothing is."""

from jbf.diagnosis.excitations import Limits
from jbf.diagnosis.experiment import Experiment
from jbf.diagnosis.many import diagnose_many
from jbf.diagnosis.result import Diagnosis, Remainder, Step, Trial
from jbf.diagnosis.search import diagnose

__all__ = [
    "Diagnosis",
    "Experiment",
    "Limits",
    "Remainder",
    "Step",
    "Trial",
    "diagnose",
    "diagnose_many",
]
