"""Compensation schemes that contain a friction model."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from jbf.control.bench import Bench, core_model
from jbf.control.constants import TABLE_ENTRIES
from jbf.control.schemes.scheme import Unguarded
from jbf.control.settings import Settings
from jbf.control.task import Task
from jbf.control.tuning import tune
from jbf.models.model import Model


@dataclass(frozen=True)
class Table(Unguarded):
    """Look-up table of the model's steady friction over speed, zero at rest."""

    model: Model
    name: str = "table"

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """Return the arguments from which the core builds the compensator; see `Scheme`."""
        bearing = self.model.rig.bearing
        radius_m = 1.0 if bearing is None else bearing.radius_m
        width = max(task.top_speed_rad_s, 1.0) / (TABLE_ENTRIES - 1)
        speeds = np.maximum(np.arange(TABLE_ENTRIES) * width, 1e-3 * width) * radius_m
        levels = self.model.steady_friction(speeds) * bench.volts_per_n
        # A ramp through rest. The full level with the sign of an estimated speed would cause
        # hunting.
        levels[0] = 0.0
        return {
            "kind": "table",
            "levels_v": levels.tolist(),
            "by_angle": False,
            "width": width,
            "viscous_v_s": 0.0,
        }


@dataclass(frozen=True)
class Observed:
    """Compensation by a friction model that an observer corrects.

    Attributes
    ----------
    model
        Friction model.
    settings
        Settings of the observer; by default those of `tune`.
    start
        Initial corrections of the level and at rest, V.
    name
        Name of the scheme.
    """

    model: Model
    settings: Settings | None = None
    start: tuple[float, float] = (0.0, 0.0)
    name: str = "observed"

    def guard(self, bench: Bench) -> Settings:
        """Return the settings of the loop guard; see `Scheme`."""
        return tune(self.model, bench) if self.settings is None else self.settings

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """Return the arguments from which the core builds the compensator; see `Scheme`."""
        return {
            "kind": "observed",
            "model": core_model(self.model),
            "settings": asdict(self.guard(bench)),
            "start": self.start,
        }
