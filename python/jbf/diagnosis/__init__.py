"""Diagnosis: which physical effects a friction model lacks, or that no effect is missing.

Input: a rig and its runs. Output: a `Diagnosis` with the verdict, the effects with their evidence,
a ledger of decreasing errors, the residual structure and the run to record next.

Modules: `candidates` fits the models and `evidence` compares them. `selection` adds and reviews
effects. `residual_structure` tests the residual for lack of fit. `verdict` states the verdict.
`policy` holds every number that influences a verdict. `recipe` combines these steps. `power`
computes the detection limits of the runs, and `experiment_design` proposes further runs.

May import: `jbf.records`, `jbf.models`, `jbf.estimation`, `jbf.comparison`.
"""

from jbf.diagnosis.experiment_design.excitations import Limits
from jbf.diagnosis.experiment_design.next_run import Experiment
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
