"""Reporting of results as text, tables, figures, HTML pages and JSON.

Input: `Fit`, `Comparison`, `Diagnosis` and their parts. Output: text for a terminal, rows of
cells, matplotlib axes, self-contained HTML. The package computes no statistics and takes no
decisions.

May import: every package that produces results (`jbf.records` to `jbf.diagnosis`). None of these
packages imports it: `presenters` and `pictures` register its functions with `jbf.results`.
"""
