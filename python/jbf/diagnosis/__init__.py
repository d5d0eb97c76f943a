"""Diagnosis: which physical effect is missing from a model, and when nothing is.

Comes in: a rig and runs. Goes out: `Diagnosis`: verdict, effects with their evidence, a ledger of
errors that fall, what remains, and the run to record next. `candidates` fits, `evidence` weighs,
`selection` adds and questions, `remainder` tests what is left, `verdict` says it, `policy` has
every number that decides; `recipe` puts them together.

May import: `jbf.records`, `jbf.models`, `jbf.estimation`, `jbf.comparison`.
"""

from jbf.diagnosis.excitations import Limits
from jbf.diagnosis.experiment import Experiment
from jbf.diagnosis.ledger import Remainder, Step, Trial
from jbf.diagnosis.many import diagnose_many
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.recipe import diagnose
from jbf.diagnosis.result import Diagnosis

__all__ = [
    "Diagnosis",
    "Experiment",
    "Limits",
    "Policy",
    "Remainder",
    "Step",
    "Trial",
    "diagnose",
    "diagnose_many",
]
