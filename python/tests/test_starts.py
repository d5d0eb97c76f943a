"""Where a fit starts: what pages say of it, and what the data make of that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from by_hand import coulomb
from campaigns import campaign
from jbf import Rig, Run, diagnose
from jbf.estimation.campaign import Campaign
from jbf.estimation.scales import scales
from jbf.estimation.starts import (
    CAMPAIGN_RULES,
    LINEAR_RULES,
    RULES,
    RULES_BESIDE_THE_CATALOGUE,
    RULES_OF_ANY_LAW,
    with_starts,
)
from jbf.models.catalogue import Parameter, effects, laws, parameters_of

EVERY_RULE = {
    **RULES,
    **LINEAR_RULES,
    **CAMPAIGN_RULES,
    **RULES_OF_ANY_LAW,
    **RULES_BESIDE_THE_CATALOGUE,
}
MINE = Parameter("F_n", "N", lower=1e-6, upper=1e7, starts=(10.0,), start="kinetic")


def prepared() -> Campaign:
    rig, runs, _ = campaign(7)
    return Campaign.prepare(rig, runs)


def test_each_start_that_a_page_names_has_a_rule_and_each_rule_a_page() -> None:
    pages = [p for x in (*laws().values(), *effects().values()) for p in x.parameters]
    assert {p.start for p in pages} == {"catalogue", *EVERY_RULE}
    assert {p.bound for p in pages} == {"catalogue", "transition_speed"}


def test_a_law_that_scales_with_the_load_keeps_the_catalogues_starts() -> None:
    pages = parameters_of("journal", ("presliding", "drive_compliance", "coulomb_drag"))
    found = with_starts(pages, prepared(), in_newtons=False)
    assert {name: page.starts for name, page in found.items()} == {
        name: page.starts for name, page in pages.items()
    }
    assert found["U_tr_m_s"].upper < pages["U_tr_m_s"].upper


def test_a_page_of_any_name_starts_where_it_says() -> None:
    data = prepared()
    found = with_starts({"mine.F_n": MINE}, data, in_newtons=True)["mine.F_n"]
    sizes = scales(data)
    assert found.starts == pytest.approx((sizes.kinetic_n, sizes.whole_n))
    assert found.lower == MINE.lower


def test_a_drive_starts_from_the_data_on_a_linear_axis_alone() -> None:
    pages = parameters_of("coulomb", ("drive_compliance",))
    name = "drive_compliance.k_n_m_rad"
    found = with_starts(pages, prepared(), in_newtons=True)
    assert found[name].starts == pages[name].starts


def test_a_play_starts_as_shares_of_the_stroke_on_a_linear_axis_alone() -> None:
    pages = parameters_of("coulomb", ("backlash",))
    name = "backlash.gap_rad"
    assert with_starts(pages, prepared(), in_newtons=True)[name].starts == pages[name].starts
    for top in (0.02, 2.0):
        t = np.arange(0.0, 20.0, 0.01)
        v = top * np.sin(2.0 * t)
        data = Campaign.prepare(Rig(), [Run.from_arrays(t, v, coulomb(t, v, v), name="axis")])
        # From one end to the other it goes as far as twice its amplitude.
        assert with_starts(pages, data, in_newtons=True)[name].starts == pytest.approx(
            (1e-2 * top, 1e-3 * top, 1e-4 * top), rel=0.01
        )


@pytest.mark.parametrize("gap_m", [4e-5, 4e-4, 4e-3])
def test_a_play_of_any_size_is_found_on_a_linear_axis(gap_m: float) -> None:
    """Turning round, the axis slides without friction until the gap is crossed."""
    runs = []
    for k, (rate, pull) in enumerate([(0.5, 0.02), (0.8, 0.03), (1.1, 0.02), (0.6, 0.05)]):
        t = np.arange(0.0, 30.0, 0.01)
        v, path = pull * np.sin(rate * t), pull / rate * (1.0 - np.cos(rate * t))
        turned = np.zeros(len(t))
        for turn in np.arange(np.pi / rate, t[-1], np.pi / rate):
            turned[t >= turn] = pull / rate * (1.0 - np.cos(rate * turn))
        crossing = (np.abs(path - turned) < gap_m) & (t > np.pi / rate)
        noise = 0.05 * np.random.default_rng(k).standard_normal(len(t))
        force = np.where(crossing, 0.0, coulomb(t, v, v)) + noise
        runs.append(Run.from_arrays(t, v, force, name=f"{k}"))
    found = diagnose(Rig(), runs, law="coulomb")
    assert found.effects == ("backlash",)
    assert found.model.parameters["backlash.gap_rad"].value == pytest.approx(gap_m, rel=0.1)


def test_a_time_starts_within_a_usual_run() -> None:
    data = prepared()
    found = with_starts(parameters_of("coulomb", ("warm_up",)), data, in_newtons=True)
    whole = sorted(p.run.duration_s for p in data.prepared)
    starts = found["warm_up.tau_s"].starts
    assert all(0.05 * whole[0] < start < 0.5 * whole[-1] for start in starts)


@pytest.mark.parametrize("step_s", [1e-3, 0.02, 1.5])
def test_a_lateness_starts_from_what_a_sample_resolves(step_s: float) -> None:
    time = step_s * np.arange(400)
    velocity = np.sin(2.0 * np.pi * time / (100.0 * step_s))
    run = Run.from_arrays(time, velocity, 5.0 * np.sign(velocity), name="slow")
    for effect in ("time_delay", "sensor_lag"):
        page = f"{effect}.tau_s"
        pages = parameters_of("coulomb", (effect,))
        starts = with_starts(pages, Campaign.prepare(Rig(), [run]), in_newtons=True)[page].starts
        usual = pages[page].starts
        assert starts[: len(usual)] == usual
        shorter = np.array([min(usual), *starts[len(usual) :]])
        np.testing.assert_allclose(shorter[:-1] / shorter[1:], 3.0)
        assert min(starts) <= 0.25 * step_s or starts == usual
        assert starts == usual or min(starts) > 0.25 * step_s / 3.0


def test_a_cells_errors_start_as_a_share_of_the_largest_force() -> None:
    """Of a watch and of a press alike, and whatever the law."""
    rig, runs, _ = campaign(7)
    names = ("sensor_hysteresis.w_n", "sensor_nonlinearity.c_1_n2")
    pages = parameters_of("journal", ("sensor_hysteresis", "sensor_nonlinearity"))
    for scale in (1.0, 1e3):
        scaled = [replace(run, friction_n=scale * run.friction_n) for run in runs]
        data = Campaign.prepare(rig, scaled)
        largest = max(float(np.max(np.abs(p.friction_n))) for p in data.prepared)
        for in_newtons in (False, True):
            found = with_starts(pages, data, in_newtons=in_newtons)
            (play,), (cubic,) = (found[name].starts for name in names)
            assert 0.01 * largest < play < 0.05 * largest
            # The same share of the reading, there.
            assert cubic * (play / 0.03) ** 2 == pytest.approx(0.03)
