"""Pictures: each function draws one idea on the matplotlib axes it is given, or on a new figure's,
and returns them.

>>> import jbf.plot
>>> ax = jbf.plot.stribeck(diagnosis.after)       # doctest: +SKIP
>>> jbf.plot.save(ax, "stribeck.svg")             # doctest: +SKIP

Comes in: comparisons, diagnoses, fits, runs of the loop. Goes out: matplotlib axes, dressed with
the units and words of the rig; no window opens. One idea a file; matplotlib is imported when
something is drawn. Colours can be told apart by people who confuse red and green. docs/pictures.md
shows all.

May import: every room below but the workbench's and reporting's.
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
