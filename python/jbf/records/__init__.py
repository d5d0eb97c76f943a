"""Records: files in; runs, a rig and the motion that each run imposed out.

Comes in: CSV files of runs, the rig's TOML file, or arrays. Goes out: `Run` (checked columns, SI),
`Rig`, and `ImposedMotion` (speed, acceleration and path with their errors, rests, and the samples
at which the sign of the motion is known). Knows nothing of models.

May import: `jbf.errors`, `jbf.text_files`, `jbf.units`.
"""
