"""Comparison of models with records: size and location of the errors of a model.

Input: a `Model` and runs. Output: `Comparison`, with each axis along which the residual has a
pattern. `axes` sorts samples into bins; `patterns` tests the significance of the bin means.

May import: `jbf.records`, `jbf.models`, `jbf.estimation`.
"""
