"""rigsim: an independent simulator of a friction rig with hidden effects."""

from .axes import AXIS_EFFECTS, OF_TEMPERATURE, AxisRun, axis_campaign
from .bearing import Base, Bearing
from .campaign import Campaign, draw_base, simulate_campaign, standard, write_campaign
from .catalogue import BY_THERMOMETER, CATALOGUE, draw
from .foreign import FOREIGN, draw_foreign
from .motions import Motion, multisine, polyline, sine, steps, stop_and_go, sweep, triangle
from .noise import Noise
from .record import Record
from .simulate import simulate_run
from .warmth import Warmth

__all__ = [
    "AXIS_EFFECTS",
    "BY_THERMOMETER",
    "CATALOGUE",
    "FOREIGN",
    "OF_TEMPERATURE",
    "AxisRun",
    "Base",
    "Bearing",
    "Campaign",
    "Motion",
    "Noise",
    "Record",
    "Warmth",
    "axis_campaign",
    "draw",
    "draw_base",
    "draw_foreign",
    "multisine",
    "polyline",
    "simulate_campaign",
    "simulate_run",
    "sine",
    "standard",
    "steps",
    "stop_and_go",
    "sweep",
    "triangle",
    "write_campaign",
]
