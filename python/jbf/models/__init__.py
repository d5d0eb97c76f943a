"""Models: a law, effects and parameters; a run's motion in, a predicted friction out.

Comes in: a `Rig`, names out of the catalogue, parameter values, and runs to predict. Goes out:
predictions and their derivatives, model files, trajectories and batches of the bare law. Every
number of physics is the core's (`jbf._core`); nothing here fits or judges.

May import: `jbf.records`, `jbf._core`.
"""
