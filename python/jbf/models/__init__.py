"""Models: prediction of friction from the motion of a run by a law with effects and parameters.

Input: a `Rig`, names from the catalogue, parameter values, and runs to predict. Output: predictions
and their derivatives, model files, trajectories and batches of the base law. All physics is
computed by the core (`jbf._core`). This package neither fits nor compares.

May import: `jbf.records`, `jbf._core`.
"""
