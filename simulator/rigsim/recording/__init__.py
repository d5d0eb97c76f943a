"""Loggers: recording artefacts at three strengths, applied to the exact signals of a rig."""

from .campaign import recorded, write_recorded
from .catalogue import ARTEFACTS, OFF_GRID, ONE_OF
from .ranges import STRENGTHS

__all__ = ["ARTEFACTS", "OFF_GRID", "ONE_OF", "STRENGTHS", "recorded", "write_recorded"]
