"""JSON data of the tables of Cohn (1998), and of the robustness of a compensator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from jbf.control.robustness import Outcome
from jbf.control.thesis_tables import Tables


def tables_dict(tables: Tables, alternatives: Sequence[tuple[str, Tables]]) -> dict[str, Any]:
    """Data of `jbf control tables --json`."""
    values = {n: p.value for n, p in tables.model.parameters.items()}
    return {
        "friction": {"volts_per_n": tables.bench.volts_per_n, **values},
        "cells": [{**asdict(cell), "ratio": cell.ratio} for cell in tables.cells.values()],
        "within_2": tables.within(2.0),
        "within_1.5": tables.within(1.5),
        "times_better": tables.gains(),
        "assumptions": [
            {
                "name": name,
                "ratios": {f"{c.row}, {c.column}": c.ratio for c in alternative.predicted},
                "within_2": alternative.within(2.0),
                "within_1.5": alternative.within(1.5),
            }
            for name, alternative in alternatives
        ],
    }


def robustness_dict(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Data of `jbf control robustness --json`."""
    return {"cases": [{**asdict(o), "worst": o.worst, "verdict": o.verdict} for o in outcomes]}
