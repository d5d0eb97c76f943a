"""Commands with their one-line descriptions, in the order of the help.

They are defined here and not in the modules of the commands, so that the help of `jbf` imports
none of them.
"""

from __future__ import annotations

COMMANDS: dict[str, str] = {
    "demo": "the whole story on shipped data with a hidden effect, in under a minute",
    "workbench": "a page on this machine: see runs, find what is missing, watch the error fall",
    "import": "from recordings as they are (CSV, Excel, MAT, HDF5, TDMS, MDF4, MCAP, ...) to a "
    "campaign",
    "compare": "model against measurement: how far, and where it fails",
    "fit": "fit the base law, with named effects, to runs",
    "diagnose": "which effect is missing: adds it and shows the error fall, until nothing is "
    "missing",
    "power": "how strong each effect must be for planned runs to show it",
    "check": "how often the diagnosis of campaigns like this one is right, by simulating them",
    "plan": "which runs to record, so that they show most of what could be missing",
    "predict": "friction of the model under a run's motion, as time_s, friction_n",
    "export": "the model's constants and the calls that build it, as source for firmware",
    "effects": "the catalogue of effects: forms, parameters, sources",
    "control": "friction compensation in the loop: runs, the thesis's tables, settings, robustness",
}
