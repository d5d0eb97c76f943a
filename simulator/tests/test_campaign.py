"""Tests of motions, noise, foreign effects, seeds, files and the command line."""

import json

import numpy as np
import pytest
from rigsim import (
    FOREIGN,
    Base,
    Campaign,
    Noise,
    draw_base,
    draw_foreign,
    simulate_campaign,
    simulate_run,
    sine,
    standard,
    triangle,
    write_campaign,
)
from rigsim.__main__ import main

SHORT = Campaign("short", (sine("bi", 7.0, 0.127, 1.0), triangle("tri", 5.0, 0.1, 1.5)))


@pytest.mark.parametrize("name", ["full", "heldout", "slow", "steady"])
def test_simulated_motion_is_continuous_with_speed_as_derivative_of_position(name):
    for motion in standard(name).motions:
        edges = [motion.pieces[0].t0, *(p.t1 for p in motion.pieces)]
        assert edges[0] == 0.0
        assert edges[-1] == pytest.approx(motion.duration_s)
        for piece in motion.pieces:
            t = np.linspace(piece.t0, piece.t1, 40)
            v = np.array([piece.speed(x) for x in t])
            x = np.array([piece.position(s) for s in t])
            assert np.all(v * piece.sign >= -1e-9)
            fine = 0.5 * (v[1:] + v[:-1]) * np.diff(t)
            assert x[-1] - x[0] == pytest.approx(fine.sum(), abs=2e-3 * (1e-3 + abs(x[-1] - x[0])))
        for a, b in zip(motion.pieces[:-1], motion.pieces[1:], strict=True):
            assert a.speed(a.t1) == pytest.approx(b.speed(b.t0), abs=1e-12)
            assert a.position(a.t1) == pytest.approx(b.position(b.t0), abs=1e-12)


def test_simulated_record_is_repeated_by_the_same_seed_and_changed_by_another():
    one, truth = simulate_campaign(3, ["coulomb_drag"], campaign=SHORT)
    two, again = simulate_campaign(3, ["coulomb_drag"], campaign=SHORT)
    other, _ = simulate_campaign(4, ["coulomb_drag"], campaign=SHORT)
    assert truth == again
    np.testing.assert_array_equal(one["bi"].friction, two["bi"].friction)
    assert not np.array_equal(one["bi"].friction, other["bi"].friction)


def test_rig_noise_and_effect_size_of_a_seed_do_not_depend_on_other_effects():
    _, alone = simulate_campaign(3, ["coulomb_drag"], campaign=SHORT)
    _, both = simulate_campaign(3, ["sensor_lag", "coulomb_drag"], campaign=SHORT)
    assert alone["base"] == both["base"]
    assert alone["noise_n"] == both["noise_n"]
    assert alone["effects"]["coulomb_drag"] == both["effects"]["coulomb_drag"]


def test_reported_noise_equals_the_standard_deviation_of_the_recorded_noise():
    records, truth = simulate_campaign(6, campaign=SHORT)
    gap = np.concatenate([r.friction - r.clean_friction_n for r in records.values()])
    assert np.std(gap) == pytest.approx(truth["noise_n"], rel=0.1)
    assert 0.01 <= truth["noise_n"] / (truth["base"]["f_m"] * truth["base"]["load_n"]) <= 0.025
    assert all(w == 0.0 for w in truth["effect_to_noise"].values())


def test_coloured_noise_has_its_variance_and_lag_one_correlation():
    rng = np.random.default_rng(1)
    noisy = Noise(1.0, coloured_share=0.5).friction(np.zeros(50_000), 0.02, rng)
    assert np.std(noisy) == pytest.approx(np.sqrt(1.25), rel=0.03)
    lag_one = np.mean(noisy[1:] * noisy[:-1]) / np.mean(noisy**2)
    assert lag_one == pytest.approx(0.2 * np.exp(-0.1), abs=0.03)


def test_recorded_speed_at_rest_is_zero_and_the_angle_is_in_encoder_counts():
    rng = np.random.default_rng(1)
    record = simulate_run(Base(), {}, SHORT.motions[0], noise=Noise(0.1), rng=rng)
    assert record.velocity[0] == 0.0
    counts = record.angle_rad * 2387.3
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)


@pytest.mark.parametrize("name", FOREIGN)
def test_foreign_effect_changes_the_record_and_repeats_with_its_seed(name):
    strange = [draw_foreign(name, np.random.default_rng(2))]
    motion = SHORT.motions[0]
    base = draw_base(1)
    runs = [
        simulate_run(base, {}, motion, foreign=strange, rng=np.random.default_rng(7)).friction
        for _ in range(2)
    ]
    np.testing.assert_array_equal(runs[0], runs[1])
    gap = runs[0] - simulate_run(base, {}, motion).friction
    assert np.sqrt(np.mean(gap**2)) > 0.02


def test_csv_of_a_simulated_run_has_the_documented_columns_and_digits(tmp_path):
    truth = write_campaign(tmp_path, 2, ["sensor_offset"], campaign=SHORT)
    lines = (tmp_path / "bi.csv").read_text().splitlines()
    assert lines[0] == "time_s,angle_rad,velocity_m_s,friction_n,load_n"
    assert len(lines) == 352
    assert [len(x.split(".")[1]) for x in lines[5].split(",")] == [3, 5, 6, 4, 1]
    assert "-0.000000" not in (tmp_path / "bi.csv").read_text()
    rig = (tmp_path / "rig.toml").read_text()
    assert f"normal_n = {truth['base']['load_n']}" in rig


def test_simulator_command_writes_campaign_held_out_runs_and_truth(tmp_path):
    truth_file = tmp_path / "truth.json"
    hidden = ["--effects", "coulomb_drag", "--foreign", "hum", "--seed", "3"]
    places = ["--heldout", str(tmp_path / "b"), "--truth", str(truth_file)]
    code = main([str(tmp_path / "a"), "--campaign", "steady", *hidden, *places])
    assert code == 0
    truth = json.loads(truth_file.read_text())
    assert list(truth["effects"]) == ["coulomb_drag"]
    assert list(truth["foreign"]) == ["hum"]
    assert (tmp_path / "b" / "multi.csv").exists()


def test_simulator_command_refuses_an_unknown_effect(tmp_path, capsys):
    assert main([str(tmp_path / "c"), "--effects", "magic"]) == 2
    assert "magic" in capsys.readouterr().err
