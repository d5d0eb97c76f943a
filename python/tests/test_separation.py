"""A motion that is not yet recorded: as a run to play, and what parts two models in it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import coulomb, four_runs
from jbf import Limits, Rig, Run
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.excitations import Excitation, excitations
from jbf.diagnosis.separation import (
    MOST_SAMPLES,
    SIMULATED,
    Rival,
    filled_limits,
    motions,
    played,
)
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE
from jbf.models.chain import core_load_n

Array = npt.NDArray[np.float64]
STEP_S = 0.02


# ---- a motion as a run -------------------------------------------------------------------------


@pytest.mark.parametrize("linear", [False, True])
def test_a_motion_to_play_has_its_way(linear: bool) -> None:
    """0.1 m/s^2 for two seconds are 0.2 m; on a shaft of 25.4 mm that is an angle of 7.87."""
    rig = Rig() if linear else Rig.thesis()
    t: Array = STEP_S * np.arange(101.0)
    run = played(rig, Excitation("up", 0.1 * t, None), STEP_S, linear=linear)
    assert run.name == "next"
    assert run.time_s == pytest.approx(t)
    assert run.velocity_m_s == pytest.approx(0.1 * t)
    place = run.position_m if linear else run.angle_rad
    bearing = rig.bearing
    assert place == pytest.approx(0.05 * t**2 / (1.0 if bearing is None else bearing.radius_m))
    assert (run.angle_rad if linear else run.position_m) is None
    assert run.temperature_c is None


def test_a_motion_is_under_its_load_and_at_its_temperature() -> None:
    """Where it says none, under the rig's own load, and at no temperature that is known."""
    rig, v = Rig.thesis(), np.zeros(20)
    usual = played(rig, Excitation("rest", v, None), STEP_S, linear=False)
    other = played(rig, Excitation("rest", v, 55.0, 31.0), STEP_S, linear=False)
    assert usual.load_n is not None
    assert other.load_n is not None
    assert other.temperature_c is not None
    assert other.load_n.tolist() == [55.0] * 20
    assert other.temperature_c.tolist() == [31.0] * 20
    assert usual.load_n.tolist() == [core_load_n(rig)] * 20
    assert played(Rig(), Excitation("rest", v, None), STEP_S, linear=True).load_n is None


def at_hand(*steps_s: float, position: bool = False) -> Any:
    """Candidates of runs that move at up to 0.1 m/s, read so often."""
    motion = SimpleNamespace(
        velocity_m_s=np.array([0.0, 0.1]), acceleration_m_s2=np.array([0.0, 0.2])
    )
    place = np.zeros(2) if position else None
    prepared = [
        SimpleNamespace(step_s=s, motion=motion, run=SimpleNamespace(load_n=None, position_m=place))
        for s in steps_s
    ]
    campaign = SimpleNamespace(prepared=prepared, has_loads=False, temperatures_k=None, rig=Rig())
    return SimpleNamespace(campaign=campaign)


def test_a_run_is_read_as_often_as_those_at_hand_and_no_longer_than_6000_samples() -> None:
    limits, step_s = filled_limits(at_hand(0.01, 0.02, 0.05), None)
    assert (limits, step_s) == (Limits(0.1, 0.2, 60.0), 0.02)
    given = Limits(duration_s=240.0)
    assert MOST_SAMPLES == 6000
    assert filled_limits(at_hand(0.01, 0.02, 0.05), given)[1] == 0.04
    assert filled_limits(at_hand(0.01), given)[0].duration_s == 240.0


@pytest.mark.parametrize("position", [False, True])
def test_each_motion_within_the_limits_is_played(position: bool) -> None:
    """By position where any of the runs at hand has one."""
    limits = Limits(0.1, 0.2, 30.0)
    found = list(motions(at_hand(STEP_S, position=position), limits, STEP_S))
    wanted = list(excitations(limits, STEP_S, "m/s"))
    assert [excitation.words for excitation, *_ in found] == [x.words for x in wanted]
    for (_, run, _), x in zip(found, wanted, strict=True):
        assert run.velocity_m_s == pytest.approx(x.velocity_m_s)
        assert (run.position_m is not None) == position


def test_columns_that_a_proposed_motion_has_are_known() -> None:
    assert {"angle_rad", "position_m"} <= SIMULATED
    assert "pressure_pa" not in SIMULATED


# ---- what parts two models ---------------------------------------------------------------------


@pytest.fixture(scope="module")
def rival() -> Rival:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=0.1))
    candidates = Candidates(campaign, "coulomb", "journal")
    candidates.converge(())
    return Rival(candidates.fitted(()))


def test_a_model_knows_its_noise_and_how_well_it_knows_its_parameters(rival: Rival) -> None:
    r, j = rival.solution.stacked()
    assert rival.noise_n == pytest.approx(0.1, rel=0.05)
    assert rival.noise_n**2 * (len(r) - j.shape[1]) == pytest.approx(float(r @ r))
    assert rival.known.T @ rival.known == pytest.approx(j.T @ j)


def test_a_model_under_a_motion_says_its_force_and_its_slopes(rival: Rival) -> None:
    """Dry and viscous friction; slopes by the logarithms of the parameters, that are searched."""
    t: Array = STEP_S * np.arange(200.0)
    v: Array = 0.1 + 0.05 * np.sin(t)
    campaign = Campaign.prepare(Rig(), [Run.from_arrays(t, v, coulomb(t, v, v), name="next")])
    friction, slopes = rival.at(campaign.motions[0])
    known = dict(zip(rival.problem.names, rival.solution.values.tolist(), strict=True))
    v = campaign.prepared[0].motion.velocity_m_s
    assert friction == pytest.approx(known["F_c_n"] + known["F_v_n_s_m"] * v, rel=1e-3)
    by_name = {rival.problem.names[i]: slopes[:, k] for k, i in enumerate(rival.problem.open)}
    log = dict(zip(rival.problem.names, rival.problem.log.tolist(), strict=True))
    for name, way in (("F_c_n", np.ones(len(v))), ("F_v_n_s_m", v)):
        size = known[name] if log[name] else 1.0
        assert by_name[name] == pytest.approx(size * way, rel=1e-3)


def made(known: Array, noise_n: float) -> Any:
    """A model that knows so much, in white noise."""
    found: Any = object.__new__(Rival)
    found.solution = SimpleNamespace(noise=WHITE)
    found.known, found.noise_n = known, noise_n
    return found


@pytest.mark.parametrize("noise_n", [0.1, 2.0])
def test_what_is_left_of_a_gap_is_what_no_parameter_may_move_to(noise_n: float) -> None:
    """A gap of 3 along a slope that was known to a half, and of 4 across it: of the first is left
    9 / (1 + 1/4), beside the square of the other."""
    along, across = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    model = made(np.array([[0.5]]), noise_n)
    own = (np.array([7.0, 8.0]), along[:, None])
    truth = (own[0] + 3.0 * along + 4.0 * across, own[1])
    left = 9.0 * 0.25 / 1.25 + 16.0
    assert model.separation(own, truth, STEP_S) == pytest.approx(left / noise_n**2)
    # What is known for sure cannot move, what is not known at all is made up for.
    sure = made(np.array([[1e9]]), noise_n).separation(own, truth, STEP_S)
    assert sure == pytest.approx(25.0 / noise_n**2)
    free = made(np.array([[0.0]]), noise_n).separation(own, truth, STEP_S)
    assert free == pytest.approx(16.0 / noise_n**2)


def test_without_noise_any_gap_parts_two_models() -> None:
    own = (np.zeros(2), np.array([[1.0], [0.0]]))
    truth = (np.array([0.0, 1e-3]), own[1])
    assert made(np.array([[1.0]]), 0.0).separation(own, truth, STEP_S) > 1e100
    assert made(np.array([[1.0]]), 0.0).separation(own, own, STEP_S) == 0.0
