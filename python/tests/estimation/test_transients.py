"""Films that respond too fast for the sampling rate, and the reuse of computed film paths."""

from contextlib import nullcontext
from typing import Any

import jbf
import numpy as np
import pytest
from input_errors import input_error
from jbf import InputError, Lubricant, Rig, Run
from jbf.diagnosis.which_law import followed
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.estimation.settings import DEFAULT as SETTINGS
from jbf.estimation.transients import check_film_rate
from jbf.models.chain import chain


def sine_run(step_s: float, rate_rad_s: float, samples: int = 3000) -> Run:
    t = step_s * np.arange(samples)
    v = 0.05 * np.sin(rate_rad_s * t)
    return Run.from_arrays(t, v, 20.0 * np.sign(v) + 30.0 * v, name="sine")


IN_SECONDS = sine_run(0.02, 0.8)
IN_MILLISECONDS = sine_run(20.0, 0.8e-3)


def film_rate_1_s(run: Run, seed: dict[str, float] | None = None) -> float:
    problem = Problem(Campaign.prepare(Rig.thesis(), [run]), "journal", "journal", ())
    motions = problem.campaign.motions
    return min(problem.chain.film_rate_1_s(s, motions) for s in problem.starts(seed or {}))


@pytest.mark.parametrize("call", [jbf.fit, jbf.diagnose])
def test_times_in_milliseconds_are_rejected_with_a_hint_at_the_unit(call: Any) -> None:
    error = input_error(call, Rig.thesis(), [IN_MILLISECONDS], law="journal")
    assert (error.column, error.file) == ("time_s", "sine")
    assert "unit of time" in str(error.remedy)


def test_laws_without_a_film_accept_times_in_milliseconds() -> None:
    campaign = Campaign.prepare(Rig.thesis(), [IN_MILLISECONDS])
    for law in ("coulomb", "stribeck", "lugre"):
        check_film_rate(campaign, law, "journal")


def test_law_selection_excludes_film_laws_if_times_are_in_milliseconds() -> None:
    campaign = Campaign.prepare(Rig.thesis(), [IN_MILLISECONDS])
    candidates, refused = followed(campaign, "journal")
    assert "stribeck" in candidates
    assert not {"journal", "journal_full"} & set(candidates)
    assert "law journal" in refused


@pytest.mark.parametrize(("share", "accepted"), [(0.9, True), (1.1, False)])
def test_sampling_too_coarse_for_the_film_is_rejected(share: float, accepted: bool) -> None:
    step_s = share * SETTINGS.film.max_steps / film_rate_1_s(IN_SECONDS)
    campaign = Campaign.prepare(Rig.thesis(), [sine_run(step_s, 0.01)])
    with nullcontext() if accepted else pytest.raises(InputError, match="time_s"):
        check_film_rate(campaign, "journal", "journal")


@pytest.mark.parametrize(("share", "accepted"), [(0.9, True), (1.1, False)])
def test_coarse_sampling_is_accepted_for_few_film_steps(share: float, accepted: bool) -> None:
    samples = 30
    duration_s = share * SETTINGS.film.any_steps / film_rate_1_s(IN_SECONDS)
    step_s = duration_s / (samples - 1)
    assert step_s * film_rate_1_s(IN_SECONDS) > SETTINGS.film.max_steps
    campaign = Campaign.prepare(Rig.thesis(), [sine_run(step_s, 3.0 / duration_s, samples)])
    with nullcontext() if accepted else pytest.raises(InputError, match="time_s"):
        check_film_rate(campaign, "journal", "journal")


def test_film_rate_check_uses_the_starting_value_given_by_the_user() -> None:
    seed = {"U_tr_m_s": 1e-5}
    slower = film_rate_1_s(IN_MILLISECONDS, seed)
    assert slower != film_rate_1_s(IN_MILLISECONDS)
    campaign = Campaign.prepare(Rig.thesis(), [IN_MILLISECONDS])
    with pytest.raises(InputError, match=f"{1.0 / slower:.1g} s"):
        check_film_rate(campaign, "journal", "journal", seed)


# ---- cached film paths of a motion ---------------------------------------------------------------

VALUES = np.array([0.26, 0.06, 7.5e5, 33.0])
THICKER = Rig(Rig.thesis().bearing, Lubricant(viscosity_pa_s=0.003), Rig.thesis().load)
CHANGES: dict[str, tuple[Rig, Any, list[float]]] = {
    "reference": (Rig.thesis(), "journal", [1.0, 1.0, 1.0, 1.0]),
    "transition speed": (Rig.thesis(), "journal", [1.0, 1.1, 1.0, 1.0]),
    "stiffness": (Rig.thesis(), "journal", [1.0, 1.0, 1.1, 1.0]),
    "friction level": (Rig.thesis(), "journal", [1.1, 1.0, 1.0, 0.9]),
    "viscosity": (THICKER, "journal", [1.0] * 4),
    "clock": (Rig.thesis(), "thesis", [1.0] * 4),
}


def film_campaign() -> Campaign:
    return Campaign.prepare(Rig.thesis(), [sine_run(0.02, 1.0, 600)])


def test_cached_film_path_is_recomputed_if_parameters_rig_or_clock_change() -> None:
    used, answers = film_campaign().motions, set()
    for rig, clock, scale in [*CHANGES.values(), *CHANGES.values()]:
        model = chain(rig, "journal", clock, ())
        (found,) = model.predict(VALUES * scale, used)
        (fresh,) = model.predict(VALUES * scale, film_campaign().motions)
        np.testing.assert_array_equal(found, fresh)
        answers.add(found.tobytes())
    assert len(answers) == len(CHANGES)


@pytest.mark.parametrize("effects", [(), ("coulomb_drag", "sensor_lag"), ("film_memory",)])
def test_derivatives_from_a_cached_film_path_match_differences(effects: tuple[str, ...]) -> None:
    model, used = chain(Rig.thesis(), "journal", "journal", effects), film_campaign().motions
    count = len(model.parameter_names)
    values = np.concatenate([VALUES, [1.0, 0.05][: count - 4]])
    (value,) = model.predict(values, used)
    [(again, slopes)] = model.jacobian(values, used, range(count))
    np.testing.assert_array_equal(again, value)
    for k in range(count):
        step = 1e-5 * values[k] * (np.arange(count) == k)
        (above,) = model.predict(values + step, film_campaign().motions)
        (below,) = model.predict(values - step, film_campaign().motions)
        expected = (above - below) / (2.0 * step[k])
        assert np.max(np.abs(expected)) > 0.0
        assert np.max(np.abs(slopes[:, k] - expected)) < 1e-4 * np.max(np.abs(expected))
