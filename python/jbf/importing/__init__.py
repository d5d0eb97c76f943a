"""Import recordings from files of other programs as runs and a rig, without changes to the files.

Input: files in any format of `formats`, and a map that defines the columns, the units and the
cutting into runs. Output: a campaign folder (runs as CSV, `rig.toml`) with its ledger. Without a
map, the output is a proposed map with the open questions. Each channel keeps its original time
stamps, without resampling. The package does not depend on friction models.

May import: `jbf.records`, `jbf.results` and the packages below them.
"""
