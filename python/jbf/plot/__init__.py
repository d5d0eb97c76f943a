"""Plots: each function draws one topic on the given matplotlib axes, or on those of a new figure.

>>> import jbf.plot
>>> ax = jbf.plot.stribeck(diagnosis.after)       # doctest: +SKIP
>>> jbf.plot.save(ax, "stribeck.svg")             # doctest: +SKIP

Input: comparisons, diagnoses, fits, control-loop runs. Output: matplotlib axes, labelled with the
quantities and units of the rig. No window is opened. Each module covers one topic; matplotlib is
imported when something is drawn. The colours are distinguishable with red-green colour blindness.
docs/pictures.md shows all plots.

May import: every package below, except `jbf.workbench` and `jbf.reporting`.
"""

from jbf.plot.control import control_trace
from jbf.plot.ledger import ledger
from jbf.plot.loops import loops
from jbf.plot.maps import friction_map, residual_map
from jbf.plot.parameters import parameters
from jbf.plot.power import power
from jbf.plot.ranking import ranking
from jbf.plot.residuals import residual_along, residual_in_time, residuals_in_a_row
from jbf.plot.spectra import spectrum
from jbf.plot.stribeck import stribeck
from jbf.plot.style import save
from jbf.plot.traces import record_and_model

__all__ = [
    "control_trace",
    "friction_map",
    "ledger",
    "loops",
    "parameters",
    "power",
    "ranking",
    "record_and_model",
    "residual_along",
    "residual_in_time",
    "residual_map",
    "residuals_in_a_row",
    "save",
    "spectrum",
    "stribeck",
]
