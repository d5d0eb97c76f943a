"""Findings against the simulator's recordings: each artefact is told of, and nothing else."""

from __future__ import annotations

from functools import cache

import pytest
from jbf.estimation.campaign import Campaign
from jbf.records.findings.finding import Finding
from jbf.records.rig import Bearing, Load, Lubricant, Rig
from recorded.judge import found
from rigruns import runs_of
from rigsim.recording import OFF_GRID, recorded

SEED = 1003
"""Three short runs: starts and stops, a sweep, slow and fast."""
WITHOUT_A_MODEL = (
    "backward_velocity",
    "coarse_velocity",
    "dropout",
    "filtered_velocity",
    "gaps",
    "jitter",
    "noisy_load",
    "position_glitch",
    "quantised",
    "saturation",
    "slow_force",
    "spikes",
)
UNSEEN = ("retared", "runs_differ", "skew", "drifting_clock", "gain_by_run", "long_memory")
"""Artefacts that take a model to see."""


def prepared(artefact: str, strength: str) -> Campaign:
    records, truth = recorded(SEED, (), (artefact,), strength)
    sizes = dict(truth["base"]["bearing"])
    lubricant = Lubricant(sizes.pop("viscosity_pa_s"))
    rig = Rig(Bearing(**sizes), lubricant, Load(truth["base"]["load_n"]))
    return Campaign.prepare(rig, runs_of(records))


@cache
def findings(artefact: str) -> tuple[Finding, ...]:
    return prepared(artefact, "usual").findings


@pytest.mark.parametrize("artefact", WITHOUT_A_MODEL)
def test_an_artefact_is_told_of(artefact: str) -> None:
    told, silent, untrue = found((artefact,), {finding.kind for finding in findings(artefact)})
    assert (told, silent, untrue) == ([artefact], [], [])


@pytest.mark.parametrize("artefact", [OFF_GRID, *UNSEEN])
def test_nothing_is_made_up(artefact: str) -> None:
    assert findings(artefact) == ()


def test_sizes_are_those_of_the_recording() -> None:
    """As the simulator has them written down."""
    for artefact, kind, size in (
        ("quantised", "steps", "step_n"),
        ("saturation", "saturation", "limit_n"),
        ("jitter", "jitter", "rms_s"),
    ):
        _, truth = recorded(SEED, (), (artefact,), "usual")
        true = {done["run"]: done["size"][size] for done in truth["recording"]}
        said = {f.run: f.size for f in findings(artefact) if f.kind == kind}
        assert said
        for run, value in said.items():
            assert value == pytest.approx(true[run], rel=0.25)


def test_a_late_speed_is_late_in_every_run() -> None:
    late = [f for f in findings("filtered_velocity") if f.kind == "filtered_speed"]
    assert len(late) == 3
    # 5 Hz, of second order: the root of two over its angular frequency.
    assert {round(f.size / 0.045, 0) for f in late} == {1.0}


def test_a_noisy_load_is_one_load() -> None:
    clean = prepared(OFF_GRID, "usual")
    assert prepared("noisy_load", "severe").has_loads == clean.has_loads
