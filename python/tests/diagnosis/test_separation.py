"""Separation of two models in a planned motion, after the wrong one is fitted again."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import coulomb, four_runs
from jbf import Limits, Rig, Run
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.excitations import Excitation, excitations
from jbf.diagnosis.separation import MOST_SAMPLES, Rival, filled_limits, motions, played
from jbf.estimation.campaign import Campaign
from jbf.records.run import Run as RunType

Array = npt.NDArray[np.float64]
STEP_S = 0.02


@pytest.mark.parametrize("linear", [False, True])
def test_planned_motion_has_the_path_of_its_velocity(linear: bool) -> None:
    """0.1 m/s^2 for two seconds are 0.2 m; on a shaft the angle is the path over the radius."""
    rig = Rig() if linear else Rig.thesis()
    t = STEP_S * np.arange(101.0)
    run = played(rig, Excitation("up", 0.1 * t, None), STEP_S, linear=linear)
    assert run.time_s == pytest.approx(t)
    assert run.velocity_m_s == pytest.approx(0.1 * t)
    radius_m = 1.0 if rig.bearing is None else rig.bearing.radius_m
    path = run.position_m if linear else run.angle_rad
    assert path == pytest.approx(0.05 * t**2 / radius_m)
    assert (run.angle_rad if linear else run.position_m) is None
    assert (run.friction_n, run.temperature_c) == (None, None)


def test_planned_motion_has_the_given_load_and_temperature_or_the_load_of_the_rig() -> None:
    rig, v = Rig.thesis(), np.zeros(20)
    assert rig.load is not None
    usual = played(rig, Excitation("rest", v, None), STEP_S, linear=False)
    given = played(rig, Excitation("rest", v, 55.0, 31.0), STEP_S, linear=False)
    assert np.unique(usual.load_n) == pytest.approx([rig.load.normal_n])
    assert np.unique(given.load_n) == pytest.approx([55.0])
    assert np.unique(given.temperature_c) == pytest.approx([31.0])
    assert played(Rig(), Excitation("rest", v, None), STEP_S, linear=True).load_n is None


def candidates_of(*steps_s: float, position: bool = False) -> Candidates:
    """Candidates for slides at up to 0.1 m/s and 0.2 m/s^2, sampled at these steps."""
    records: list[RunType] = []
    for k, step_s in enumerate(steps_s):
        t = step_s * np.arange(int(20.0 / step_s))
        v = 0.1 * np.sin(2.0 * t)
        noise = 0.1 * np.random.default_rng(k).standard_normal(len(t))
        path = {"position_m": 0.05 * (1.0 - np.cos(2.0 * t))} if position else {}
        records.append(Run.from_arrays(t, v, coulomb(t, v, v) + noise, name=f"{k}", **path))
    return Candidates(Campaign.prepare(Rig(), records), "coulomb", "journal")


def test_planned_run_has_the_median_step_of_the_runs_and_6000_samples_at_most() -> None:
    tried = candidates_of(0.01, 0.02, 0.05)
    limits, step_s = filled_limits(tried, None)
    assert step_s == pytest.approx(0.02)
    assert limits.velocity_m_s == pytest.approx(0.1, rel=1e-3)
    assert limits.duration_s == 60.0
    assert MOST_SAMPLES == 6000
    long, coarser_s = filled_limits(tried, Limits(duration_s=240.0))
    assert (long.duration_s, coarser_s) == (240.0, 0.04)


@pytest.mark.parametrize("position", [False, True])
def test_every_motion_within_the_limits_is_a_candidate(position: bool) -> None:
    """With a position if the runs have one, else with an angle."""
    limits = Limits(0.1, 0.2, 20.0)
    found = list(motions(candidates_of(STEP_S, position=position), limits, STEP_S))
    expected = list(excitations(limits, STEP_S, "m/s"))
    assert [excitation.words for excitation, *_ in found] == [x.words for x in expected]
    for (_, run, _), x in zip(found, expected, strict=True):
        assert run.velocity_m_s == pytest.approx(x.velocity_m_s)
        assert (run.position_m is not None) == position


@pytest.fixture(scope="module")
def rival() -> Rival:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=0.1))
    tried = Candidates(campaign, "coulomb", "journal")
    tried.converge(())
    return Rival(tried.fitted(()))


def test_noise_and_information_of_a_rival_are_those_of_a_regression(rival: Rival) -> None:
    r, j = rival.solution.stacked()
    assert rival.noise_n == pytest.approx(0.1, rel=0.05)
    assert rival.noise_n**2 * (len(r) - j.shape[1]) == pytest.approx(float(r @ r))
    assert rival.known.T @ rival.known == pytest.approx(j.T @ j)


def test_friction_and_slopes_in_a_motion_are_those_of_the_law(rival: Rival) -> None:
    """Dry friction is searched in its logarithm, viscous friction is not."""
    t = STEP_S * np.arange(200.0)
    v = 0.1 + 0.05 * np.sin(t)
    noise = 0.1 * np.random.default_rng(0).standard_normal(200)
    campaign = Campaign.prepare(Rig(), [Run.from_arrays(t, v, coulomb(t, v, v) + noise)])
    friction, slopes = rival.at(campaign.motions[0])
    known = dict(zip(rival.problem.names, rival.solution.values.tolist(), strict=True))
    assert friction == pytest.approx(known["F_c_n"] + known["F_v_n_s_m"] * v, rel=1e-3)
    column = {rival.problem.names[i]: slopes[:, k] for k, i in enumerate(rival.problem.open)}
    assert column["F_c_n"] == pytest.approx(np.full(200, known["F_c_n"]), rel=1e-3)
    assert column["F_v_n_s_m"] == pytest.approx(v, rel=1e-3)


@pytest.mark.parametrize("direction", ["dry", "viscous", "new"])
def test_separation_is_the_residual_square_of_a_fit_to_old_and_new_runs(
    rival: Rival, direction: str
) -> None:
    """The least of |gap - X s|^2 + |K s|^2 over a common step s, by normal equations."""
    t = STEP_S * np.arange(400.0)
    v = 0.1 + 0.05 * np.sin(t)
    noise = 0.1 * np.random.default_rng(0).standard_normal(400)
    campaign = Campaign.prepare(Rig(), [Run.from_arrays(t, v, coulomb(t, v, v) + noise)])
    own = rival.at(campaign.motions[0])
    gap = {"dry": 0.3 + 0.0 * t, "viscous": 3.0 * v, "new": 0.3 * np.sin(7.0 * t)}[direction]
    information = own[1].T @ own[1] + rival.known.T @ rival.known
    explained = own[1].T @ gap
    left = float(gap @ gap - explained @ np.linalg.pinv(information) @ explained)
    separation = rival.separation(own, (own[0] + gap, own[1]), STEP_S)
    assert separation == pytest.approx(left / rival.noise_n**2, rel=1e-6)
    # The old runs constrain the parameters: a part of the gap remains even along the law's slopes.
    assert 0.1 * float(gap @ gap) < left < float(gap @ gap)
    assert rival.separation(own, own, STEP_S) == pytest.approx(0.0, abs=1e-9)
