"""The workbench: a page on loopback on which runs, models and the error falling can be seen.

Comes in: a folder. Goes out: what the page asks for. `serve` opens it, `app` and `actions` answer,
`guard` lets nobody else in, `files` keeps to the folder. `session` holds the `bench` (rig and runs)
and the tree of `models`; `jobs` runs each fit in a process of its own (`work`). `views`, `series`,
`thinning`, `plane` and `marks` make pictures small enough to send.

May import: every room but `cli`.
"""
