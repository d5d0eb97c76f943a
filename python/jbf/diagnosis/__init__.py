"""Which physical effect is missing from a model, and when nothing is."""

from jbf.diagnosis.result import Diagnosis, Remainder, Step, Trial
from jbf.diagnosis.search import diagnose

__all__ = ["Diagnosis", "Remainder", "Step", "Trial", "diagnose"]
