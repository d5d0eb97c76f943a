"""Sizes of a campaign, and the starting values that follow from them."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from campaigns import campaign
from jbf import InputError, Parameter, Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.starting_values import (
    CAMPAIGN_RULES,
    LINEAR_RULES,
    OF_ANY_LAW,
    RULES,
    Scales,
    scales,
    with_starts,
)
from jbf.models.catalogue import effects, laws, parameters_of

SIZES = Scales(
    median_n=7.0,
    kinetic_n=5.0,
    viscous_n_s_m=20.0,
    breakaway_n=8.0,
    slow_m_s=0.01,
    usual_m_s=0.1,
    stroke_m=0.4,
    resolved_m=1e-6,
)
TIME = 0.02 * np.arange(800)
SPEED = 0.1 * np.sin(TIME)
CATALOGUE = (1.0, 0.5)


def page(start: str = "catalogue", **more: Any) -> Parameter:
    return Parameter("p", start=start, **{"lower": 1e-3, "upper": 1e3, "starts": CATALOGUE, **more})


def axis(name: str = "a", scale: float = 1.0, **columns: Any) -> Run:
    path = 0.1 * (1.0 - np.cos(TIME))
    force = columns.pop("force", scale * (5.0 * np.sign(SPEED) + 20.0 * SPEED))
    return Run.from_arrays(TIME, SPEED, force, position_m=path, name=name, **columns)


def started(one: Parameter, *runs: Run, rig: Rig | None = None, in_newtons: bool = True) -> Any:
    """Parameter with starting values from these runs, by default from one run of an axis."""
    prepared = slide() if rig is None and not runs else Campaign.prepare(rig or Rig(), list(runs))
    return with_starts({"p": one}, prepared, in_newtons=in_newtons)["p"]


@cache
def slide() -> Campaign:
    return Campaign.prepare(Rig(), [axis()])


@cache
def on_bearing() -> Campaign:
    rig, runs, _ = campaign(7)
    return Campaign.prepare(rig, runs[:2])


def test_every_starting_value_rule_named_in_the_catalogue_exists() -> None:
    rules = (RULES, LINEAR_RULES, CAMPAIGN_RULES, OF_ANY_LAW)
    pages = [p for x in (*laws().values(), *effects().values()) for p in x.parameters]
    assert {p.start for p in pages} == {"catalogue", *(name for rule in rules for name in rule)}


@pytest.mark.parametrize(
    ("rule", "starts"),
    [
        ("kinetic", (5.0, 7.0)),
        ("breakaway", (8.0,)),
        ("breakaway_excess", (3.0,)),
        ("viscous", (20.0, 0.0)),
        ("stribeck_speed", (0.01, 0.03, 0.1)),
        ("usual_speed", (0.1,)),
        ("slowness", (5.0, 50.0)),
        # Breakaway within a tenth of the stroke, within 1e-6 m, and within their geometric mean.
        ("stiffness", (200.0, 4e4, 8e6)),
        ("damping", (2.5,)),
        ("drag", (0.5,)),
        ("drive_play", (4e-3, 4e-4, 4e-5)),
        ("drive_stiffness", (2e3, 2e4)),
        # A stiffness of 2e3 N/m whose oscillation period is a fiftieth of the 4 s of a stroke.
        ("drive_inertia", (2e3 * 0.08**2,)),
        ("drive_damping", (80.0,)),
    ],
)
def test_starting_values_of_each_catalogue_rule_are_computed_from_typical_magnitudes(
    rule: str, starts: tuple[float, ...]
) -> None:
    assert (RULES | LINEAR_RULES)[rule](SIZES) == pytest.approx(starts)


def test_law_in_newtons_takes_its_starting_values_from_the_data() -> None:
    sizes = scales(slide())
    assert started(page("kinetic")).starts == (sizes.kinetic_n, sizes.median_n)
    assert sizes.kinetic_n == pytest.approx(5.0, rel=0.05)
    assert started(page()) == page()


def test_law_that_scales_with_the_load_takes_its_starting_values_from_the_catalogue() -> None:
    pages = parameters_of("journal", ("presliding", "drive_compliance", "coulomb_drag"))
    data = on_bearing()
    found = with_starts(pages, data, in_newtons=False)
    assert {n: p.starts for n, p in found.items()} == {n: p.starts for n, p in pages.items()}
    # Only the transition speed is bounded by the fastest recorded speed.
    top = max(float(np.max(np.abs(p.motion.velocity))) for p in data.prepared)
    wanted = max(5.0 * top, 2.0 * max(pages["U_tr_m_s"].starts))
    assert found["U_tr_m_s"].upper == pytest.approx(min(wanted, pages["U_tr_m_s"].upper))


@pytest.mark.parametrize(
    ("starts", "upper", "bound"), [((0.05,), 1e3, 0.5), ((0.5, 2.0), 1e3, 4.0), ((0.05,), 0.3, 0.3)]
)
def test_upper_bound_of_the_transition_speed_is_five_times_the_fastest_speed(
    starts: tuple[float, ...], upper: float, bound: float
) -> None:
    one = page(starts=starts, upper=upper, bound="transition_speed")
    assert started(one, in_newtons=False).upper == pytest.approx(bound, rel=0.01)


@pytest.mark.parametrize("name", ["drive_compliance.k", "backlash.gap"])
def test_drive_effect_starts_are_estimated_from_the_data_only_on_a_linear_axis(name: str) -> None:
    pages = parameters_of("coulomb", (name.partition(".")[0],))
    shaft, axis_ = (with_starts(pages, c, in_newtons=True)[name] for c in (on_bearing(), slide()))
    assert shaft.starts == pages[name].starts
    assert axis_.starts == pytest.approx(LINEAR_RULES[pages[name].start](scales(slide())))


@pytest.mark.parametrize(("true", "starts"), [(3.0, (3.0,)), (-3.0, CATALOGUE)])
def test_mass_starts_at_the_regression_coefficient_of_the_acceleration(
    true: float, starts: tuple[float, ...]
) -> None:
    """A coefficient with the wrong sign is not a mass."""
    force = 5.0 * np.sign(SPEED) + 20.0 * SPEED + true * 0.1 * np.cos(TIME)
    assert started(page("mass"), axis(force=force)).starts == pytest.approx(starts, rel=0.02)


def test_time_constants_start_at_0_3_and_0_1_of_the_run_duration() -> None:
    assert started(page("run_time")).starts == pytest.approx((0.3 * TIME[-1], 0.1 * TIME[-1]))


def test_starting_delays_decrease_threefold_from_0_5_s_to_a_quarter_of_a_step() -> None:
    wanted = (*CATALOGUE, *(0.5 / 3.0**k for k in range(1, 6)))
    for in_newtons in (False, True):
        assert started(page("lateness"), in_newtons=in_newtons).starts == pytest.approx(wanted)
    assert started(page("lateness", starts=(0.004,))).starts == (0.004,)


def test_stroke_dependence_starts_at_the_middle_and_half_length_of_the_stroke() -> None:
    assert started(page("stroke_middle")).starts == pytest.approx((0.1,), abs=0.005)
    # A tenth of the path is added at either end.
    assert started(page("stroke_half")).starts == pytest.approx((0.12,), abs=0.002)


@pytest.mark.parametrize(("more", "upper"), [({}, 0.1), ({"upper": 0.01}, 0.01)])
def test_pitch_is_bounded_by_half_of_the_path(more: dict[str, float], upper: float) -> None:
    assert started(page("pitch", **more)).upper == pytest.approx(upper, rel=0.02)
    assert started(page("pitch", **more), in_newtons=False).upper == page(**more).upper


@pytest.mark.parametrize(("scale", "in_newtons"), [(1.0, False), (1e3, True)])
def test_load_cell_errors_start_at_3_percent_of_the_force(scale: float, in_newtons: bool) -> None:
    run = axis(force=scale * 5.0 * np.sign(SPEED) * np.where(np.arange(len(TIME)) == 400, 1e3, 1.0))
    for rule, start in (("cell_play", 0.15 * scale), ("cell_cubic", 0.03 / (25.0 * scale**2))):
        found = started(page(rule, lower=1e-12, upper=1e9), run, in_newtons=in_newtons)
        assert found.starts == pytest.approx((start,))


def test_reference_temperature_is_that_of_the_lubricant_or_the_mean_of_the_runs() -> None:
    celsius = (np.full(len(TIME), mean) for mean in (20.2, 25.0))
    runs = [axis(f"{k}", 1.0 + 0.1 * k, temperature_c=c) for k, c in enumerate(celsius)]
    one, thesis = page("reference_temperature"), Rig.thesis()
    assert started(one, *runs).starts == (23.0,)
    assert started(one).starts == CATALOGUE
    for stated, start in ((41.0, 41.0), (None, 23.0)):
        rig = replace(thesis, lubricant=replace(thesis.lubricant, temperature_c=stated))
        assert started(one, *runs, rig=rig).starts == (start,)


STEP_S = 0.01


def swinging(force: float = 5.0, viscous: float = 20.0, top: float = 0.1) -> Run:
    """A sine with a period of 4 s has strokes of 2 s with a length of 4 / pi times `top`."""
    t = np.arange(0.0, 40.0, STEP_S)
    v = top * np.sin(0.5 * np.pi * t)
    return Run.from_arrays(t, v, force * np.sign(v) + viscous * v, name="sine")


def sizes_of(*runs: Run) -> Scales:
    return scales(Campaign.prepare(Rig(), list(runs)))


def strokes(*lengths_m: float) -> Run:
    ends = np.cumsum(np.array(lengths_m) / 0.1)
    t = np.arange(0.0, ends[-1], STEP_S)
    v = 0.1 * np.where(np.searchsorted(ends, t, side="right") % 2, -1.0, 1.0)
    return Run.from_arrays(t, v, 5.0 * np.sign(v), name="strokes")


@pytest.mark.parametrize("top", [0.01, 1.0])
@pytest.mark.parametrize("force", [0.5, 50.0])
def test_scales_of_linear_friction_in_a_sine_motion_are_the_analytical_ones(
    top: float, force: float
) -> None:
    viscous = force / top
    found = sizes_of(swinging(force, viscous, top))
    assert found.kinetic_n == pytest.approx(force, rel=0.02)
    assert found.viscous_n_s_m == pytest.approx(viscous, rel=0.02)
    # Median and 10 % quantile of the absolute value of a sine.
    assert found.usual_m_s == pytest.approx(top * np.sin(0.25 * np.pi), rel=0.03)
    assert found.slow_m_s == pytest.approx(top * np.sin(0.05 * np.pi), rel=0.15)
    assert found.median_n == pytest.approx(force + viscous * found.usual_m_s, rel=0.02)
    # 90 % quantile of the slow half.
    slow = top * np.sin(0.9 * 0.25 * np.pi)
    assert found.breakaway_n == pytest.approx(force + viscous * slow, rel=0.02)
    assert found.stroke_m == pytest.approx(top * 4.0 / np.pi, rel=0.02)
    # The value is a tenth of the distance between samples at the slow speed.
    assert found.resolved_m == pytest.approx(0.1 * found.slow_m_s * STEP_S, rel=1e-6)


def test_viscous_scale_is_zero_if_friction_falls_with_speed() -> None:
    found = sizes_of(swinging(5.0, -10.0))
    assert found.viscous_n_s_m == 0.0
    assert found.kinetic_n == pytest.approx(5.0 - 10.0 * 0.1 * np.sin(np.pi / 8.0), rel=0.02)
    assert found.breakaway_n >= 1.1 * found.kinetic_n


@pytest.mark.parametrize(
    ("lengths_m", "stroke_m"),
    [
        # The record truncates the first and the last stroke: the median of the others is used.
        ((0.3, 1.0, 0.6, 0.8, 0.5), 0.8),
        # Overshoots of a drive: distances below a tenth of the longest are not strokes.
        ((0.3, 1.0, 0.12, 1.0, 0.12, 0.5), 0.56),
        ((0.3, 1.0, 0.06, 1.0, 0.06, 0.5), 1.0),
        # With fewer than two reversals the stroke is the length of the path.
        ((0.4, 0.9), 0.9),
    ],
)
def test_stroke_is_the_median_distance_between_reversals(lengths_m: Any, stroke_m: float) -> None:
    assert sizes_of(strokes(*lengths_m)).stroke_m == pytest.approx(stroke_m, rel=0.03)


@pytest.mark.parametrize(("start", "most_s"), [("lateness", 0.4), ("run_time", 48.0)])
def test_times_are_bounded_by_the_durations_of_the_runs(start: str, most_s: float) -> None:
    runs = []
    for name, samples in (("short", 200), ("long", 800)):
        t, v = TIME[:samples], SPEED[:samples]
        runs.append(Run.from_arrays(t, v, np.sign(v) + v, name=name))
    upper = started(page(start, unit="s"), *runs).upper
    assert upper == pytest.approx(most_s, rel=0.01)
    assert started(page(start, unit="m"), *runs).upper == 1e3


def test_rest_and_speeds_below_two_percent_of_the_top_do_not_count_as_motion() -> None:
    t = np.arange(0.0, 40.0, STEP_S)
    half = t < 20.0
    v = 0.1 * np.sin(0.5 * np.pi * t)

    def moving(second_half: Array) -> Array:
        run = Run.from_arrays(t, np.where(half, v, second_half), np.sign(v))
        ((_, mask),) = Campaign.prepare(Rig(), [run]).moving
        assert mask[half].mean() > 0.9
        return mask[~half]

    assert not moving(np.zeros(len(t)))[50:].any()
    assert not moving(0.0015 * np.sign(np.sin(20.0 * t))).any()
    assert moving(np.full(len(t), 0.0025)).mean() > 0.9


def test_one_force_outlier_does_not_change_the_scales_of_a_campaign() -> None:
    run = swinging()
    force = np.where(np.arange(len(run)) == 777, 1e5, run.friction)
    plain, found = sizes_of(run), sizes_of(replace(run, friction=force))
    for name, value in vars(plain).items():
        assert getattr(found, name) == pytest.approx(value, rel=0.02), name


def test_campaign_without_counted_samples_is_rejected_with_its_file() -> None:
    runs = [replace(swinging(force), name=f"{force}") for force in (5.0, 6.0)]
    runs[0] = replace(runs[0], path=Path("first.csv"))
    campaign = Campaign.prepare(Rig(), runs)
    nothing = campaign.without([np.ones(len(p.run), dtype=bool) for p in campaign.prepared])
    with pytest.raises(InputError) as refused:
        scales(nothing)
    assert (str(refused.value.file), refused.value.column) == ("first.csv", "velocity_m_s")
