"""Channels that were read by clocks of their own: nothing is resampled, nothing is invented."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf import InputError, Run
from jbf.estimation.prepared import Prepared
from jbf.records.channels import OWN_CLOCK

LAW = {"F_c_n": 4.0, "F_v_n_s_m": 20.0}
NOISE_N = 0.05


def channels(
    force_hz: float = 90.0, motion_hz: float = 400.0, seed: int = 1, lasts_s: float = 30.0
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """A slide by closed forms: position and speed at one rate, the force at another."""
    random = np.random.default_rng(seed)
    motion = np.arange(0.0, lasts_s, 1.0 / motion_hz)
    force = np.arange(0.0017, lasts_s - 0.01, 1.0 / force_hz)

    def speed(t: np.ndarray) -> np.ndarray:
        return 0.1 * np.sin(1.7 * t) + 0.05 * np.sin(4.1 * t + 1.0)

    place = -0.1 / 1.7 * np.cos(1.7 * motion) - 0.05 / 4.1 * np.cos(4.1 * motion + 1.0)
    v = speed(force)
    friction = LAW["F_c_n"] * np.sign(v) + LAW["F_v_n_s_m"] * v
    return {
        "position_m": (motion, np.round(place, 6)),
        "velocity_m_s": (motion, speed(motion) + 1e-4 * random.standard_normal(len(motion))),
        "friction_n": (force, friction + NOISE_N * random.standard_normal(len(force))),
    }


def test_the_model_is_compared_at_the_readings_of_the_force() -> None:
    given = channels()
    run = Run.from_channels(given, name="slide")
    assert len(run) > len(given["position_m"][0])
    prepared = Prepared.of(jbf.Rig(), run)
    clock, force = given["friction_n"]
    np.testing.assert_array_equal(prepared.run.time_s, clock)
    np.testing.assert_array_equal(prepared.friction_n, force)
    (finding,) = [f for f in prepared.examined.findings if f.kind == "own_clock"]
    assert finding.size == pytest.approx(90.0)
    assert "400 Hz" in finding.words
    fit = jbf.fit(jbf.Rig(), [run], law="coulomb")
    for name, value in LAW.items():
        found = fit.parameters[name]
        assert found.stderr is not None
        assert abs(found.value - value) < 4.0 * found.stderr + 1e-3 * value
    assert fit.rms_n == pytest.approx(NOISE_N, rel=0.06)


def test_the_motion_is_estimated_from_its_own_readings() -> None:
    """At the instants of the motion it is what a run without a force gives, to the bit."""
    given = channels()
    run = Run.from_channels(given)
    time_s, place = given["position_m"]
    alone = Run.from_arrays(time_s, given["velocity_m_s"][1], position_m=place)
    model = jbf.Model(jbf.Rig(), law="coulomb", parameters=LAW)
    both = model.predict(run)
    at = np.isin(run.time_s, time_s)
    kept = (alone.time_s >= run.time_s[0]) & (alone.time_s <= run.time_s[-1])
    np.testing.assert_allclose(both[at], model.predict(alone)[kept], rtol=0.0, atol=1e-12)


def test_nothing_hidden_is_adequate() -> None:
    runs = [Run.from_channels(channels(seed=k, force_hz=70.0 + k), name=f"r{k}") for k in (1, 2, 3)]
    found = jbf.diagnose(jbf.Rig(), runs, law="coulomb")
    assert (found.verdict, found.effects) == ("adequate", ())
    assert found.steps[-1].holdout_rms_n == pytest.approx(NOISE_N, rel=0.1)


def test_a_file_keeps_each_clock(tmp_path: Path) -> None:
    """Empty cells are what was not read; what was reads back to the bit."""
    run = Run.from_channels(channels(), name="slide")
    path = tmp_path / "slide.csv"
    run.write_csv(path)
    assert any(",," in line for line in path.read_text().splitlines())
    again = jbf.read_run(path)
    assert set(again.read) == set(run.read) == {"friction_n", "position_m", "velocity_m_s"}
    for name, values in run.columns().items():
        there = run.read.get(name, np.ones(len(run), dtype=bool))
        np.testing.assert_array_equal(again.columns()[name][there], values[there])
        np.testing.assert_array_equal(again.read.get(name, there), there)
    assert again.to_csv() == run.to_csv()


def test_a_part_of_a_run_keeps_its_clocks() -> None:
    run = Run.from_channels(channels())
    half = run.select(slice(0, len(run) // 2))
    np.testing.assert_array_equal(half.read["friction_n"], run.read["friction_n"][: len(half)])
    only = run.select(run.read["friction_n"])
    assert "friction_n" not in only.read
    np.testing.assert_array_equal(only.friction_n, channels()["friction_n"][1])


def test_one_clock_is_a_run_as_always() -> None:
    given = channels()
    clock, force = given["friction_n"]
    same = {name: (clock, np.interp(clock, t, v)) for name, (t, v) in given.items()}
    run = Run.from_channels(same)
    assert run.read == {}
    plain = Run.from_arrays(clock, same["velocity_m_s"][1], force, position_m=same["position_m"][1])
    assert run.to_csv() == replace(plain, name="run").to_csv()


@pytest.mark.parametrize(
    ("column", "wrong", "says"),
    [
        ("friction_n", ([0.0, 1.0], [1.0]), "friction_n: has 1 values at 2 instants"),
        ("friction_n", ([0.0, 1.0], [1.0, 2.0]), "friction_n: has 2 readings; a run needs"),
        ("friction_n", (np.arange(20.0)[::-1], np.ones(20)), "runs back; sort"),
        ("friction_n", (np.arange(20.0), np.full(20, np.nan)), "is not all finite numbers"),
        ("load_n", ([0.0], [np.inf]), "is not all finite numbers"),
    ],
)
def test_a_wrong_channel_is_one_line(column: str, wrong: tuple, says: str) -> None:
    with pytest.raises(InputError, match=says):
        Run.from_channels(channels() | {column: wrong})


def test_no_motion_is_one_line() -> None:
    with pytest.raises(InputError, match="no position tells the motion"):
        Run.from_channels({"friction_n": channels()["friction_n"]})


def test_few_empty_cells_are_gaps_and_many_a_clock(tmp_path: Path) -> None:
    rows = [f"{0.01 * i},{np.sin(0.01 * i)},{np.sign(np.sin(0.01 * i))}" for i in range(1000)]
    path = tmp_path / "a.csv"
    for every, clock in ((2, True), (19, True), (21, False)):
        assert (1.0 / every >= OWN_CLOCK) is clock
        some = [r.rpartition(",")[0] + "," if i % every == 1 else r for i, r in enumerate(rows)]
        path.write_text("time_s,velocity_m_s,friction_n\n" + "\n".join(some))
        if clock:
            assert np.count_nonzero(jbf.read_run(path).read["friction_n"]) < len(rows)
            continue
        with pytest.raises(InputError, match="row 3, column friction_n: the cell is empty"):
            jbf.read_run(path)
