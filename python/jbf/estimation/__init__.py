"""Estimation: a model and runs in; parameters with their errors out.

Comes in: a `Campaign` (runs made ready once), a law, effects. Goes out: `Fit`, `Bootstrap`,
`TrajectoryFit`. `samples` says which samples count and how much, `noise` what the instrument adds,
`problem` encodes parameters and predicts, `minimum` searches, `uncertainty` gives the errors;
`determined` is the rule by which a parameter is held.

May import: `jbf.records`, `jbf.models`, `jbf._core`.
"""
