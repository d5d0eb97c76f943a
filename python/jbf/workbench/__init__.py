"""Workbench: a local web page on the loopback interface that shows runs, models and errors.

Input: a folder. Output: the responses to the requests of the page. `serve` starts the server,
`app` and `actions` handle the requests. `guard` rejects requests of other pages, and `files`
restricts access to the folder. `session` holds the `bench` (rig and runs) and the tree of
`models`; `jobs` runs each fit in a separate process (`work`). `views`, `series`, `thinning`,
`plane` and `marks` reduce the data of plots to a size suitable for transfer.

May import: every package except `cli`.
"""
