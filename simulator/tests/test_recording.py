"""Tests of each recording artefact: its channel, its reported size, repeatability."""

import json
from functools import cache

import numpy as np
import pytest
from rigsim.recording import ARTEFACTS, OFF_GRID, STRENGTHS, recorded, write_recorded
from rigsim.recording.catalogue import chosen

SEED = 6  # a small campaign
CLEAN, CLEAN_TRUTH = recorded(SEED)
NOISE_N = CLEAN_TRUTH["noise_n"]


@cache
def recorded_with(*artefacts, strength="usual", seed=SEED):
    """Return the recorded runs and the reported sizes of the first artefact, by run."""
    records, truth = recorded(seed, (), artefacts, strength)
    done = {entry["run"]: entry for entry in truth["recording"] if entry["kind"] == artefacts[0]}
    assert set(done) == set(records)
    return records, {run: entry["size"] for run, entry in done.items()}


def pairs(*artefacts, strength="usual"):
    """Return a run without and with the artefacts, and the reported size of the first one."""
    records, sizes = recorded_with(*artefacts, strength=strength)
    return [(CLEAN[name], records[name], sizes[name]) for name in CLEAN]


def test_recording_without_artefacts_has_only_noise_and_is_repeatable():
    again, truth = recorded(SEED)
    assert truth == CLEAN_TRUTH
    assert truth["recording"] == []
    for name, record in CLEAN.items():
        np.testing.assert_array_equal(record.friction, again[name].friction)
        noise = record.friction - record.clean_friction_n
        assert np.std(noise) == pytest.approx(NOISE_N, rel=0.1)


@pytest.mark.parametrize("name", ARTEFACTS)
def test_artefact_changes_only_the_columns_of_its_channel(name):
    of = {
        "force": {"friction"},
        "position": {"angle_rad"},
        "speed": {"velocity", "angle_rad"},
        "time": {"friction", "velocity", "angle_rad"},
        "load": {"load_n"},
        "rig": {"friction"},
    }
    if name == "gaps":
        return
    changed = set()
    for clean, record, _ in pairs(name):
        np.testing.assert_array_equal(record.time_s, clean.time_s)
        for column in ("friction", "velocity", "angle_rad", "load_n"):
            if not np.array_equal(getattr(record, column), getattr(clean, column)):
                changed.add(column)
    assert changed <= of[ARTEFACTS[name].channel]
    assert changed


@pytest.mark.parametrize(
    "strength",
    [pytest.param(s, marks=() if s == "usual" else pytest.mark.extended) for s in STRENGTHS],
)
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(n, marks=() if n in ("skew", "jitter", "gaps") else pytest.mark.extended)
        for n in ARTEFACTS
    ],
)
def test_artefact_reports_finite_sizes_and_is_repeatable(name, strength):
    records, sizes = recorded_with(name, strength=strength)
    again, truth = recorded(SEED, (), (name,), strength)
    for entry in truth["recording"]:
        assert entry["kind"] != name or entry["size"] == sizes[entry["run"]]
        assert np.isfinite(list(entry["size"].values())).all()
    for run, record in records.items():
        np.testing.assert_array_equal(record.friction, again[run].friction)
        assert np.isfinite(record.friction).all()
        assert np.isfinite(record.velocity).all()
        assert (np.diff(record.time_s) > 0.0).all()


def test_recording_artefact_is_not_changed_by_a_second_artefact():
    alone, one = recorded_with("spikes")
    both, two = recorded_with("spikes", "noisy_load")
    assert one == two
    for name, record in alone.items():
        np.testing.assert_array_equal(record.friction, both[name].friction)


def test_slow_force_channel_is_interpolated_or_held_as_reported():
    seen = set()
    for seed in (0, 6, 13, 25, 68, 92):
        records, sizes = recorded_with("slow_force", strength="severe", seed=seed)
        for name, record in records.items():
            bends = np.diff(record.friction, 2)
            still = np.mean(np.diff(record.friction) == 0.0)
            straight = np.mean(np.abs(bends) < 1e-9)
            assert (still if sizes[name]["held"] else straight) > 0.25
            seen.add(sizes[name]["held"])
    assert seen == {0.0, 1.0}


def test_clock_skew_delays_the_force_of_each_run_by_its_reported_time():
    delays_s = []
    for clean, record, size in pairs("skew"):
        moved = np.interp(clean.time_s - size["late_s"], clean.time_s, clean.clean_friction_n)
        kept = slice(20, -20)
        before = np.std((record.clean_friction_n - clean.clean_friction_n)[kept])
        after = np.std((record.clean_friction_n - moved)[kept])
        assert after < before
        assert 0.006 <= abs(size["late_s"]) <= 0.014
        delays_s.append(size["late_s"])
    assert len(set(delays_s)) == len(delays_s)


def test_clock_drift_grows_from_zero_to_the_reported_delay():
    for clean, record, size in pairs("drifting_clock"):
        gap = np.abs(record.clean_friction_n - clean.clean_friction_n)
        assert gap[0] < 1e-9
        assert size["late_at_end_s"] == pytest.approx(size["share"] * clean.time_s[-1])


def test_jitter_has_the_expected_rms_and_leaves_the_time_stamps_evenly_spaced():
    for _, record, size in pairs("jitter"):
        assert np.ptp(np.diff(record.time_s)) < 1e-9
        assert size["rms_s"] == pytest.approx(3e-3, rel=0.15)


def test_offset_artefact_of_each_run_has_the_reported_size():
    for clean, record, size in pairs("retared"):
        np.testing.assert_allclose(record.friction - clean.friction, size["zero_n"])


def test_gain_artefact_of_each_run_has_the_reported_size():
    for clean, record, size in pairs("gain_by_run"):
        gap = record.friction - clean.friction
        np.testing.assert_allclose(gap, (size["gain"] - 1.0) * clean.clean_friction_n, atol=1e-12)


def test_saturation_clips_the_force_at_the_reported_limit():
    clipped = 0.0
    for _, record, size in pairs("saturation"):
        assert np.max(np.abs(record.friction)) <= size["limit_n"]
        clipped += size["share_clipped"]
    assert clipped > 0.01


def test_quantisation_rounds_the_force_to_the_reported_step():
    for _, record, size in pairs("quantised"):
        steps = record.friction / size["step_n"]
        np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
        assert 1.5 <= size["step_n"] / NOISE_N <= 3.5


def test_spikes_have_the_reported_count_and_exceed_9_9_standard_deviations():
    for clean, record, size in pairs("spikes"):
        gap = np.abs(record.friction - clean.friction)
        assert np.sum(gap > 0.0) == size["samples"]
        assert np.max(gap) == pytest.approx(size["largest_n"])
        assert (gap[gap > 0.0] > 9.9 * NOISE_N).all()


def test_dropouts_of_the_force_repeat_the_last_value():
    for clean, record, size in pairs("dropout"):
        changed = np.flatnonzero(record.friction != clean.friction)
        assert 0 < len(changed) <= size["samples"]
        assert np.mean(np.diff(record.friction)[changed - 1] == 0.0) == 1.0


def test_position_glitches_have_the_reported_count_and_size():
    for clean, record, size in pairs("position_glitch"):
        gap = np.abs(record.angle_rad - clean.angle_rad)
        assert np.sum(gap > 0.0) == size["samples"]
        assert np.max(gap) == pytest.approx(size["largest_rad"])


def test_gaps_remove_the_reported_rows_and_keep_the_others_unchanged():
    for clean, record, size in pairs("gaps"):
        assert len(clean.time_s) - len(record.time_s) == size["rows"]
        assert np.max(np.diff(record.time_s)) >= size["stretch_s"]
        kept = np.isin(clean.time_s, record.time_s)
        np.testing.assert_array_equal(record.friction, clean.friction[kept])


def test_heavy_tailed_noise_exceeds_4_standard_deviations_in_1_of_1000_samples():
    tails = []
    for _, record, _ in pairs("heavy_tails"):
        tails.append((record.friction - record.clean_friction_n) / NOISE_N)
    noise = np.concatenate(tails)
    assert np.mean(np.abs(noise) > 4.0) > 1e-3  # white noise: 6e-5


def test_force_dependent_noise_is_larger_at_large_forces():
    ratios = []
    for clean, record, size in pairs("noise_with_force"):
        noise = record.friction - record.clean_friction_n
        large = np.abs(clean.clean_friction_n) > np.median(np.abs(clean.clean_friction_n))
        ratios.append(np.std(noise[large]) / np.std(noise[~large]))
        assert size["at_peak"] >= 1.0
    assert np.median(ratios) > 1.15


def test_noise_level_of_each_run_is_the_reported_one_and_differs_between_runs():
    levels = []
    for _, record, size in pairs("noise_by_run"):
        noise = np.std(record.friction - record.clean_friction_n)
        assert noise == pytest.approx(size["times"] * NOISE_N, rel=0.1)
        levels.append(size["times"])
    assert len(set(levels)) == len(levels)


def test_long_memory_noise_is_correlated_over_a_fifth_of_a_second():
    for clean, record, size in pairs("long_memory"):
        extra = record.friction - clean.friction
        lag = round(0.2 / (clean.time_s[1] - clean.time_s[0]))
        centred = extra - np.mean(extra)
        assert np.mean(centred[lag:] * centred[:-lag]) > 0.4 * np.mean(centred**2)
        assert 0.2 * size["sd_n"] < np.std(extra) < 2.0 * size["sd_n"]


def test_reported_factors_of_the_transition_speed_differ_between_runs():
    factors = [size["U_tr"] for _, _, size in pairs("runs_differ")]
    assert len(set(factors)) == len(factors)
    assert all(0.7 < f < 1.3 for f in factors)


def test_backward_velocity_is_the_difference_quotient_of_the_encoder_counts():
    for clean, record, size in pairs("backward_velocity"):
        step = clean.time_s[1] - clean.time_s[0]
        counts = record.angle_rad * size["counts_per_rad"]
        np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)
        radius = CLEAN_TRUTH["base"]["bearing"]["radius_m"]
        wanted = np.diff(record.angle_rad) * radius / step
        np.testing.assert_allclose(record.velocity[1:], wanted, atol=1e-9)


def test_coarse_velocity_is_averaged_over_5_samples_and_close_to_the_truth():
    for clean, record, size in pairs("coarse_velocity"):
        step = clean.time_s[1] - clean.time_s[0]
        assert size["over_s"] == pytest.approx(5.0 * step)
        assert np.std(record.velocity - clean.velocity) < 0.2 * np.std(clean.velocity)


def test_filtered_velocity_is_delayed_by_45_ms():
    for clean, record, size in pairs("filtered_velocity"):
        assert size["cut_hz"] == pytest.approx(5.0)
        delayed = np.interp(clean.time_s - 0.045, clean.time_s, clean.velocity)
        kept = clean.time_s > 0.3  # a filter of second order and 5 Hz delays by 45 ms
        gap = np.std((record.velocity - delayed)[kept])
        assert gap < 0.6 * np.std((record.velocity - clean.velocity)[kept]) + 2e-4


def test_noisy_load_has_the_reported_noise_around_the_true_load():
    for clean, record, size in pairs("noisy_load"):
        share = record.load_n / clean.load_n - 1.0
        assert np.std(share) == pytest.approx(size["sd"], rel=0.1)
        assert abs(np.mean(share)) < 0.1 * size["sd"]


def test_unknown_or_incompatible_recording_artefacts_are_refused():
    with pytest.raises(ValueError, match="no artefact named magic"):
        chosen(("magic",))
    with pytest.raises(ValueError, match="not more"):
        chosen(("coarse_velocity", "filtered_velocity"))


def test_chosen_artefacts_are_in_catalogue_order_without_the_off_grid_option():
    assert [a.name for a in chosen(("quantised", "jitter", OFF_GRID))] == ["jitter", "quantised"]


def test_files_of_recorded_campaigns_contain_runs_rig_and_truth(tmp_path):
    truth = write_recorded(tmp_path / "a", tmp_path / "b", SEED, ["sensor_offset"], ["gaps"])
    assert sorted(p.stem for p in (tmp_path / "a").glob("*.csv")) == sorted(CLEAN)
    assert len(list((tmp_path / "b").glob("*.csv"))) == 3
    assert (tmp_path / "a" / "rig.toml").read_text() == (tmp_path / "b" / "rig.toml").read_text()
    assert json.loads((tmp_path / "a.json").read_text()) == truth
    assert {entry["kind"] for entry in truth["recording"]} == {"gaps"}
    assert truth["effect_to_noise"]["sensor_offset"] > 0.1
