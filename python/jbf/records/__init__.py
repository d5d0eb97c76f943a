"""Records: read runs and rigs from files, and estimate the motion of each run.

Input: CSV files of runs, the TOML file of the rig, or arrays. Output: `Run` (checked columns, SI),
`Rig`, and `EstimatedMotion` (speed, acceleration and path with their errors, rests, and the samples
at which the sign of the motion is known). This package does not depend on models.

May import: `jbf.errors`, `jbf.text_files`, `jbf.units`.
"""
