"""Reporting: any result in; words, tables, pictures, pages and JSON out.

Comes in: `Fit`, `Comparison`, `Diagnosis` and their parts. Goes out: text for a terminal, rows of
cells, matplotlib axes, self-contained HTML. Computes no statistics and decides nothing.

May import: every room of results (`jbf.records` to `jbf.diagnosis`); no room of results imports it:
their `summary`, `plot`, `report` come here through `jbf.results`.
"""
