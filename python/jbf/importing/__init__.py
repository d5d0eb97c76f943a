"""Importing: a stranger's file in; runs and a rig out, without a hand laid on the file.

Comes in: files of any format in `formats`, and a map (which columns, which units, how to cut).
Goes out: a campaign's folder (runs as CSV, `rig.toml`) with its ledger, or, without a map, a guess
with what must be asked. Each channel keeps its clock; nothing is resampled. Knows nothing of
models.

May import: `jbf.records`, `jbf.results` and what is below.
"""
