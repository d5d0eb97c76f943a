"""Comparison of several models on the same runs, against paired computations."""

from collections.abc import Sequence

import numpy as np
import pytest
from by_hand import LAW, coulomb, one_way, there_and_back
from jbf import Drive, InputError, Model, Rig, Run, compare
from linear_campaigns import reversing_runs

NOISE_N = 0.2


def coulomb_model(force: float, rig: Rig | None = None) -> Model:
    rig = Rig() if rig is None else rig
    return Model(rig, "coulomb", parameters={**LAW, "F_c": force})


def many_runs(count: int) -> list[Run]:
    return [
        one_way(f"{i}", coulomb, direction=(-1.0) ** i, rate=2.0 + i, noise_rms=NOISE_N, seed=i)
        for i in range(count)
    ]


def residuals(model: Model, runs: Sequence[Run]) -> list[np.ndarray]:
    return [np.asarray(run.friction) - model.predict(run) for run in runs]


def test_rms_and_differences_are_those_of_single_comparisons() -> None:
    runs = many_runs(3)
    models = {"low": coulomb_model(4.7), "true": coulomb_model(5.0), "high": coulomb_model(5.6)}
    compared = compare(models, runs)
    assert [m.name for m in compared.models] == ["true", "low", "high"]
    for m in compared.models:
        assert m.rms == pytest.approx(compare(models[m.name], runs).rms)
        assert m.difference == pytest.approx(m.rms - compared.models[0].rms)
        assert compared.comparisons[m.name].rms == pytest.approx(m.rms)


def test_standard_error_is_that_of_paired_differences_over_runs() -> None:
    """Delta method for runs of equal length: the paired differences of their mean squares."""
    runs = many_runs(12)
    good, bad = coulomb_model(5.0), coulomb_model(5.1)
    compared = compare([good, bad], runs)
    assert (compared.unit, compared.units) == ("run", 12)
    a, b = (np.array([np.mean(r**2) for r in residuals(m, runs)]) for m in (bad, good))
    paired = a / (2.0 * np.sqrt(a.mean())) - b / (2.0 * np.sqrt(b.mean()))
    expected = np.std(paired, ddof=1) / np.sqrt(12)
    assert compared.models[1].stderr == pytest.approx(expected, rel=0.02)
    # Smaller than without the pairing.
    unpaired = np.std(a, ddof=1) / np.sqrt(12) / (2.0 * np.sqrt(a.mean()))
    assert compared.models[1].stderr < 0.8 * unpaired


@pytest.mark.extended
def test_interval_of_the_rms_difference_covers_the_true_difference_in_34_of_40_cases() -> None:
    covered, expected = 0, np.hypot(NOISE_N, 0.1) - NOISE_N
    for seed in range(40):
        runs = [
            one_way(f"{i}", coulomb, rate=2.0 + i, noise_rms=NOISE_N, seed=100 * seed + i)
            for i in range(8)
        ]
        other = compare([coulomb_model(5.0), coulomb_model(5.1)], runs).models[1]
        covered += abs(other.difference - expected) < 2.36 * other.stderr
    # 95 % of 40 are 38.
    assert covered >= 34


def test_strokes_are_the_units_of_few_runs() -> None:
    runs = reversing_runs(lambda i, t, force, random: force + random.normal(size=len(t)), runs=2)
    compared = compare([coulomb_model(5.0), coulomb_model(5.5)], runs)
    assert compared.unit == "stroke"
    signs = [np.sign(run.velocity) for run in runs]
    strokes = sum(1 + np.count_nonzero(np.diff(s[s != 0.0])) for s in signs)
    assert strokes - 4 <= compared.units <= strokes
    assert compared.models[1].stderr > 0.0


def test_standard_error_of_a_single_unit_is_unknown() -> None:
    compared = compare([coulomb_model(5.0), coulomb_model(6.0)], [one_way("a", coulomb)])
    assert compared.units == 1
    assert np.isnan(compared.models[1].stderr)
    assert compared.to_dict()["models"][1]["stderr"] is None


def test_models_in_a_list_are_named_by_law_and_effects() -> None:
    runs = there_and_back(coulomb, noise_rms=NOISE_N)
    models = [
        coulomb_model(5.0),
        Model(Rig(), "coulomb", ["sensor_offset"], {**LAW, "sensor_offset.b": 1.0}),
        coulomb_model(9.0),
    ]
    names = [m.name for m in compare(models, runs).models]
    assert names == ["coulomb (1)", "coulomb + sensor_offset", "coulomb (2)"]


def test_models_without_a_common_basis_are_rejected() -> None:
    runs = there_and_back(coulomb, noise_rms=NOISE_N)
    rotary = coulomb_model(5.0, Rig(drive=Drive("rotary", "torque")))
    for models, reason in (([], "no model"), ([coulomb_model(5.0), rotary], "N m"), ([3], "int")):
        with pytest.raises(InputError, match=reason):
            compare(models, runs)  # type: ignore[arg-type]
