"""Comparison: from record minus prediction to the size and location of the model's errors.

Input: a `Model` and runs. Output: `Comparison`, with each axis along which the residual has a
pattern. `axes` sorts samples into bins; `patterns` tests the means of the bins against chance.

May import: `jbf.records`, `jbf.models`, `jbf.estimation`.
"""
