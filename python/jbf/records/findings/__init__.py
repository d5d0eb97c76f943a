"""Data-quality findings: recording artefacts of a run, detected without a friction model.

Input: a `Run`. Output: `Examined`: findings (kind, channel, size, action taken) and the usable
samples of the force. Each kind of finding has its own module. This package does not depend on
models.

May import: the rest of `jbf.records`.
"""
