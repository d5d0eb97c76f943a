"""Findings: what the recording did to a run, before any physics.

Comes in: a `Run`. Goes out: `Examined`: findings (kind, channel, size, what was done) and the
samples of the force that can be used. One kind a file. Knows nothing of models.

May import: the rest of `jbf.records`.
"""
