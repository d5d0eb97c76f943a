"""Simulated servo drives with closed-loop motions, and loggers that record them.

The package shares no code with the models of `jbf`. A drive is integrated exactly between the
instants of its controller; sticking and sliding of Coulomb friction are resolved as events.
"""

from servosim.campaign import Campaign, Drawn, Record, simulate, write

__all__ = ["Campaign", "Drawn", "Record", "simulate", "write"]
