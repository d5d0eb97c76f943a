"""Design of experiments: the next run to record, and a plan of runs before the first recording.

Modules: `excitations` generates the motions that a rig can make. `next_run` proposes the motion
that discriminates between models with equal fits, or that makes undetectable effects detectable.
`plan` designs a set of runs.
"""
