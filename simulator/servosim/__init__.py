"""Simulated servo drives with closed-loop motions, and loggers that record them.

Shares no code with the models of `jbf`: the drive is integrated exactly between the instants of its
controller, with the sticking and sliding of Coulomb friction resolved as events.
"""

from servosim.campaign import Campaign, Drawn, Record, simulate, write

__all__ = ["Campaign", "Drawn", "Record", "simulate", "write"]
