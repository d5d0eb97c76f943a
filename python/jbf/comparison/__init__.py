"""Comparison: record minus prediction in; how far, and where it fails, out.

Comes in: a `Model` and runs. Goes out: `Comparison`, with each axis along which the residual has a
pattern. `axes` sorts samples into bins, `patterns` tests the bins' means against chance.

May import: `jbf.records`, `jbf.models`, `jbf.estimation`.
"""
