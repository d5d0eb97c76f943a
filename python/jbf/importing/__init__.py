"""Import recordings from files of other programs as runs and a rig, without changes to the files.

Input: files in any format of `formats`, and a map that states the columns, the units and where to
cut. Output: a campaign folder (runs as CSV, `rig.toml`) with its ledger. Without a map, the output
is a proposed map with the questions that remain open. Each channel keeps its own clock; nothing is
resampled. The package does not depend on friction models.

May import: `jbf.records`, `jbf.results` and what is below.
"""
