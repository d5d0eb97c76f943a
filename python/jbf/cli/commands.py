"""Commands with their one-line descriptions, in the order of the help.

The commands are listed here and not in the modules of the commands, so that the help of `jbf`
imports none of them.
"""

from __future__ import annotations

COMMANDS: dict[str, str] = {
    "demo": "diagnose shipped data with hidden effects, as an example of the complete workflow",
    "workbench": "open an interactive page on this machine: runs, models and their errors",
    "import": "convert recordings (CSV, Excel, MAT, HDF5, TDMS, MDF4, MCAP, ...) to runs and a rig "
    "file",
    "compare": "compare a model with measured runs: size and location of the error",
    "fit": "fit the base law, with the named effects, to measured runs",
    "diagnose": "find the effects that the base law lacks, and fit the completed model",
    "power": "compute how large each effect must be for planned runs to reveal it",
    "check": "estimate how often the diagnosis of such campaigns is correct, by simulation",
    "plan": "suggest which motions to record next",
    "predict": "predict the force of a model for the motion of a run",
    "export": "write a model for a controller, a drive or a simulator, and state the losses",
    "effects": "list the catalogue of effects with their equations, parameters and sources",
    "control": "simulate friction compensation in a control loop, and tune it",
}
