"""Channels with different clocks: combined in one run, compared at the force instants."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from input_errors import input_error
from jbf import Run
from jbf.estimation.prepared import Prepared
from jbf.records.channels import recorded_samples, side_by_side
from jbf.records.findings.separate_clock import separate_clock

LAW = {"F_c": 4.0, "F_v": 20.0}
NOISE_N = 0.05
FAST_S, SLOW_S = np.arange(0.0, 3.0, 0.1), np.arange(-0.35, 2.1, 0.2)


def test_channels_are_combined_at_all_their_instants_within_the_motion() -> None:
    fast, slow = (FAST_S, 2.0 * FAST_S), (SLOW_S, 5.0 * SLOW_S)
    columns, read = side_by_side({"velocity_m_s": fast, "friction_n": slow}, "a")
    time_s, slow_s = columns["time_s"], SLOW_S[SLOW_S >= 0.0]
    assert list(columns) == ["time_s", "velocity_m_s", "friction_n"]
    assert time_s.tolist() == sorted({*FAST_S.tolist(), *slow_s.tolist()})
    np.testing.assert_allclose(columns["velocity_m_s"], 2.0 * time_s)
    inside = time_s <= slow_s[-1]
    np.testing.assert_allclose(columns["friction_n"][inside], 5.0 * time_s[inside])
    assert time_s[read["velocity_m_s"]].tolist() == FAST_S.tolist()
    assert time_s[read["friction_n"]].tolist() == slow_s.tolist()


def test_combined_run_covers_only_the_time_common_to_its_motion_channels() -> None:
    clocks_s = {"velocity_m_s": FAST_S, "position_m": FAST_S + 0.55, "own": FAST_S - 9.0}
    columns, _ = side_by_side({name: (clock_s, FAST_S) for name, clock_s in clocks_s.items()}, "a")
    assert columns["time_s"][[0, -1]] == pytest.approx([0.55, FAST_S[-1]])


def test_channels_with_equal_clocks_are_combined_without_reading_masks() -> None:
    run = Run.from_channels({"velocity_m_s": (FAST_S, FAST_S), "friction_n": (FAST_S, -FAST_S)})
    assert run.read == {}
    assert run.to_csv() == Run.from_arrays(FAST_S, FAST_S, -FAST_S).to_csv()


@pytest.mark.parametrize(
    ("column", "channel"),
    [
        ("velocity_m_s", (FAST_S, FAST_S[1:])),
        ("friction_n", (FAST_S[:9], FAST_S[:9])),
        ("friction_n", (FAST_S[::-1], FAST_S)),
        ("own", ([], [])),
        ("own", ([np.nan], [1.0])),
        ("own", ([1.0], [np.inf])),
        ("own", ([1.0, 1.0], [1.0, 1.0])),
        ("load_n", (FAST_S, FAST_S)),
    ],
)
def test_invalid_channel_is_reported_with_its_run_and_column(column: str, channel: Any) -> None:
    channels = {"velocity_m_s": (FAST_S, FAST_S), column: channel}
    error = input_error(Run.from_channels, channels, name="a")
    assert (error.file, error.column) == ("a", column)


def test_channels_without_speed_or_position_are_rejected() -> None:
    error = input_error(Run.from_channels, {"friction_n": (FAST_S, FAST_S)})
    assert error.column == "velocity_m_s"


def test_column_has_a_separate_clock_if_ten_samples_and_five_percent_are_missing() -> None:
    for samples, missing, omitted in ((100, 9, 0), (100, 10, 10), (400, 19, 0), (400, 20, 20)):
        time_s = np.arange(float(samples))
        clock, read = recorded_samples(time_s, np.where(time_s < missing, np.nan, 1.0))
        assert (clock[0], len(clock), len(read)) == (omitted, samples - omitted, samples - omitted)


def test_clock_finding_has_the_force_rate_if_force_and_motion_rates_differ() -> None:
    index = np.arange(1000)
    run = Run.from_arrays(0.01 * index, np.sin(0.01 * index), np.cos(0.01 * index), name="a")
    # The force is compared with the fastest motion channel.
    slow = {"velocity_m_s": index % 10 == 0, "angle_rad": index % 2 == 0}
    assert "50 Hz" in separate_clock(replace(run, read=slow))[0].words
    for read, rate_hz in (
        ({"friction_n": index % 4 == 0, "velocity_m_s": index % 5 == 0}, 25.0),
        ({"friction_n": index % 4 == 0}, 25.0),
        ({"velocity_m_s": index % 4 == 0}, 100.0),
    ):
        (f,) = separate_clock(replace(run, read=read))
        assert (f.kind, f.channel, f.unit) == ("own_clock", "friction_n", "Hz")
        assert f.size == pytest.approx(rate_hz)
    assert (
        separate_clock(replace(run, read={"load_n": index % 4 == 0})) == separate_clock(run) == []
    )


def slide(force_hz: float = 90.0, motion_hz: float = 400.0, seed: int = 1) -> dict[str, Any]:
    """Channels of a slide in closed form: position and speed at one rate, force at another."""
    random = np.random.default_rng(seed)
    motion_s = np.arange(0.0, 30.0, 1.0 / motion_hz)
    force_s = np.arange(0.0017, 29.99, 1.0 / force_hz)

    def speed(t: Any) -> Any:
        return 0.1 * np.sin(1.7 * t) + 0.05 * np.sin(4.1 * t + 1.0)

    place = -0.1 / 1.7 * np.cos(1.7 * motion_s) - 0.05 / 4.1 * np.cos(4.1 * motion_s + 1.0)
    v = speed(force_s)
    friction = LAW["F_c"] * np.sign(v) + LAW["F_v"] * v
    return {
        "position_m": (motion_s, np.round(place, 6)),
        "velocity_m_s": (motion_s, speed(motion_s) + 1e-4 * random.standard_normal(len(motion_s))),
        "friction_n": (force_s, friction + NOISE_N * random.standard_normal(len(force_s))),
    }


def test_run_with_a_separate_force_clock_is_prepared_at_the_force_readings() -> None:
    channels = slide()
    prepared = Prepared.of(jbf.Rig(), Run.from_channels(channels))
    force_s, force_n = channels["friction_n"]
    np.testing.assert_array_equal(prepared.run.time_s, force_s)
    np.testing.assert_array_equal(prepared.friction, force_n)
    assert "own_clock" in {finding.kind for finding in prepared.examined.findings}


def test_fit_to_a_force_with_a_separate_clock_recovers_law_and_noise() -> None:
    fit = jbf.fit(jbf.Rig(), [Run.from_channels(slide())], law="coulomb")
    for name, value in LAW.items():
        estimate: Any = fit.parameters[name]
        assert abs(estimate.value - value) < 4.0 * estimate.stderr + 1e-3 * value
    assert fit.rms == pytest.approx(NOISE_N, rel=0.06)


def test_prediction_at_the_motion_instants_does_not_depend_on_the_force_clock() -> None:
    channels = slide()
    run = Run.from_channels(channels)
    time_s, place = channels["position_m"]
    without_force = Run.from_arrays(time_s, channels["velocity_m_s"][1], position_m=place)
    model = jbf.Model(jbf.Rig(), law="coulomb", parameters=LAW)
    of_motion = np.isin(run.time_s, time_s)
    common = (time_s >= run.time_s[0]) & (time_s <= run.time_s[-1])
    predictions = model.predict(run)[of_motion], model.predict(without_force)[common]
    np.testing.assert_allclose(*predictions, rtol=0.0, atol=1e-12)


@pytest.mark.extended
def test_diagnosis_of_channels_with_two_clocks_and_no_hidden_effect_is_adequate() -> None:
    runs = [Run.from_channels(slide(70.0 + k, seed=k), name=f"r{k}") for k in (1, 2, 3)]
    result = jbf.diagnose(jbf.Rig(), runs, law="coulomb")
    assert (result.verdict, result.effects) == ("adequate", ())
    assert result.steps[-1].held_out_rms == pytest.approx(NOISE_N, rel=0.1)


def test_csv_round_trip_preserves_the_clock_of_each_channel(tmp_path: Path) -> None:
    run = Run.from_channels(slide(), name="slide")
    run.write_csv(tmp_path / "slide.csv")
    again = jbf.read_run(tmp_path / "slide.csv")
    assert set(again.read) == set(run.read) == {"friction_n", "position_m", "velocity_m_s"}
    for name, values in run.columns().items():
        read = run.read.get(name, np.ones(len(run), dtype=bool))
        np.testing.assert_array_equal(again.columns()[name][read], values[read])
        np.testing.assert_array_equal(again.read.get(name, read), read)
    assert again.to_csv() == run.to_csv()
