"""Errors from repeated fits: they agree with the curvature's where that holds, and mend it where it
does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from campaigns import campaign
from jbf import InputError, bootstrap, fit
from jbf.estimation.bootstrap import read_again, recorded_again
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import Noise
from jbf.records.motion.roughness import noise_of


def test_errors_of_a_plain_fit_are_those_of_the_curvature() -> None:
    rig, runs, _ = campaign(5, ("coulomb_drag",))
    fitted = fit(rig, runs, ["coulomb_drag"])
    assert fitted.doubtful == ()
    found = bootstrap(fitted, runs, repeats=24, seed=1)
    for name, value in fitted.parameters.items():
        again = found.fit.parameters[name]
        assert again.value == value.value
        assert again.stderr is not None
        assert value.stderr is not None
        # The spread of 24 is known to 18 %.
        assert 1.0 <= again.stderr / value.stderr < 1.9, name
        low, high = np.quantile(found.values[name], [0.15866, 0.84134])
        assert 0.5 < 0.5 * (high - low) / value.stderr < 1.9, name
        assert abs(np.mean(found.values[name]) - value.value) < 1.5 * value.stderr, name
    assert found.fit.model.fit["bootstrap"] == 24
    same = bootstrap(fitted, runs, repeats=24, seed=1)
    assert all(np.array_equal(found.values[n], same.values[n]) for n in found.values)


def test_a_ringing_drive_says_that_its_errors_are_none() -> None:
    rig, runs, _ = campaign(4, ("drive_compliance",))
    fitted = fit(rig, runs, ["drive_compliance"])
    assert any(name.startswith("drive_compliance.") for name in fitted.doubtful)
    assert "--bootstrap" in fitted.report()


def test_a_simulated_record_has_the_instruments_of_the_measured_one() -> None:
    rig, runs, _ = campaign(5)
    prepared = Campaign.prepare(rig, runs).prepared[0]
    prepared = replace(prepared, friction_n=np.zeros(len(runs[0])))
    assert runs[0].angle_rad is not None
    noise = Noise(memory_s=0.3, colour=0.5)
    random = np.random.default_rng(2)
    zero = np.zeros(len(runs[0]))
    again = [recorded_again(prepared, zero, noise, 0.5, random) for _ in range(20)]
    white = [noise.innovations(run.friction_n, prepared.step_s) for run in again]
    assert np.std(np.concatenate(white)) == pytest.approx(0.5, rel=0.02)
    # The encoder's step, and the noise of the speed.
    steps = np.unwrap(runs[0].angle_rad)
    size = np.min(np.abs(np.diff(steps))[np.abs(np.diff(steps)) > 1e-12])
    assert again[0].angle_rad is not None
    moved = np.diff(again[0].angle_rad)[~prepared.motion.resting[1:]]
    counts = moved[1:-1] / size
    assert np.median(np.abs(counts - np.round(counts))) < 1e-6
    assert noise_of(again[0].velocity_m_s) == pytest.approx(
        noise_of(runs[0].velocity_m_s), rel=0.15
    )
    # What was not measured is not measured again.
    holes = np.where(np.arange(len(zero)) == 7, np.nan, prepared.friction_n)
    lost = recorded_again(replace(prepared, friction_n=holes), zero, noise, 0.5, random)
    assert lost.friction_n is not None
    assert np.flatnonzero(np.isnan(lost.friction_n)).tolist() == [7]


def test_a_force_of_unknown_sign_stays_as_it_was_read() -> None:
    rig, runs, _ = campaign(5)
    prepared = Campaign.prepare(rig, runs).prepared[0]
    unknown = ~prepared.motion.sign_known
    assert 0 < np.count_nonzero(unknown) < 0.1 * len(unknown)
    again = read_again(prepared, np.full(len(unknown), 99.0), np.random.default_rng(1))
    assert again.friction_n is not None
    np.testing.assert_array_equal(again.friction_n[unknown], prepared.friction_n[unknown])
    assert set(again.friction_n[~unknown]) == {99.0}


def test_what_was_held_stays_held() -> None:
    rig, runs, _ = campaign(5, ("coulomb_drag",))
    fitted = fit(rig, runs, ["coulomb_drag"], fixed={"gamma": 30.0})
    found = bootstrap(fitted, runs, repeats=19)
    assert set(found.values["gamma"]) == {30.0}
    assert found.fit.parameters["gamma"].stderr is None


def test_too_few_repeats_are_refused() -> None:
    rig, runs, _ = campaign(5)
    with pytest.raises(InputError, match="19 or more"):
        bootstrap(fit(rig, runs), runs, repeats=18)
