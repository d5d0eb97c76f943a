"""Selection of the base law by held-out error, and simpler laws in place of effects."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from delayed_runs import NOISE_N, reversing_campaign
from golden import golden, golden_campaign
from jbf import Diagnosis, Drive, Rig, Run, TimeLimit, diagnose
from jbf.diagnosis.budget import SIMPLER_LAWS
from jbf.diagnosis.compared_diagnoses import held_out_rms_of_diagnoses
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.which_law import HeldOut, LawTried, compared, followed
from jbf.estimation.campaign import Campaign

SAMPLES, STRETCHES = 4000, 40


def alternating(rms: float, stretch_variation: float = 0.0) -> list[Array]:
    """Errors of two runs whose mean square varies by a share between segments of the record."""
    stretch = (np.arange(SAMPLES) // (SAMPLES // STRETCHES)) % 2
    size = rms * np.sqrt(np.where(stretch, 1.0 + stretch_variation, 1.0 - stretch_variation))
    return list(np.split(size * np.where(np.arange(SAMPLES) % 2, 1.0, -1.0), 2))


def compare_errors(**errors: list[Array]) -> dict[str, LawTried]:
    """Laws in the order of their held-out error."""
    tried = compared(
        {name: (len(name), HeldOut(rows, rows)) for name, rows in errors.items()}, DEFAULT
    )
    return {law.law: law for law in tried}


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_laws_are_sorted_by_held_out_error_in_any_unit(unit: float) -> None:
    sizes = {"ab": 2.0 * unit, "c": unit, "def_": 3.0 * unit}
    found = compare_errors(**{name: alternating(size) for name, size in sizes.items()})
    assert list(found) == ["c", "ab", "def_"]
    assert {law.law: law.held_out_rms for law in found.values()} == pytest.approx(sizes)
    assert [law.parameters for law in found.values()] == [1, 2, 4]
    assert [law.tied for law in found.values()] == [True, False, False]


@pytest.mark.parametrize(("share", "tied"), [(0.98, True), (1.02, False)])
def test_laws_within_half_a_percent_of_error_are_tied(share: float, tied: bool) -> None:
    worse = np.sqrt(1.0 + share * (DEFAULT.laws.same_ratio**2 - 1.0))
    for unit in (1e-3, 1e3):
        found = compare_errors(a=alternating(unit), b=alternating(unit * worse))
        assert found["b"].tied == tied


@pytest.mark.parametrize(("share", "tied"), [(0.98, True), (1.02, False)])
def test_laws_within_two_standard_errors_are_tied(share: float, tied: bool) -> None:
    """The standard error of a mean over 40 segments with standard deviation s is s / sqrt(40)."""
    variation = 0.5
    mean = 1.0 + share * DEFAULT.laws.tie_sigma * variation / np.sqrt(STRETCHES)
    other = alternating(np.sqrt(mean), variation / mean)
    assert compare_errors(a=alternating(1.0), b=other)["b"].tied == tied


def test_laws_are_compared_only_at_samples_that_every_law_predicts() -> None:
    a, b = alternating(1.0), alternating(2.0)
    a[0][:500] = np.nan
    b[0][:500] = 1e6
    b[1][500:] = np.nan
    found = compare_errors(a=a, b=b)
    assert [law.held_out_rms for law in found.values()] == pytest.approx([1.0, 2.0])


def test_laws_of_a_bearing_require_a_rig_with_a_bearing() -> None:
    t = np.arange(0.0, 4.0, 0.002)
    run = Run.from_arrays(t, 0.1 * np.sin(3.0 * t), np.sign(np.sin(3.0 * t)))
    slide, bearing = (
        followed(Campaign.prepare(rig, [run]), "journal") for rig in (Rig(), Rig.thesis())
    )
    assert "journal" not in slide[0]
    assert "law journal" not in slide[1]
    assert {"coulomb", "stribeck"} <= set(slide[0])
    assert {"coulomb", "journal"} <= set(bearing[0])


def diagnosis_with_offset(law: str, offset_n: float) -> Diagnosis:
    """The diagnosis of the slide with a Stribeck curve, with an offset of the force sensor."""
    _, runs, _ = golden_campaign("slide_law_selection")
    offset = [replace(run, friction=np.asarray(run.friction) + offset_n) for run in runs]
    return diagnose(Rig(), offset, law=law)


def test_selected_law_is_the_simulated_one_with_the_noise_as_held_out_rms() -> None:
    found = golden("slide_law_selection")
    noise_rms = golden_campaign("slide_law_selection")[2]
    assert found.model.law == found.laws[0].law == "stribeck"
    laws = {law.law: law for law in found.laws}
    assert laws["stribeck"].held_out_rms == pytest.approx(noise_rms, rel=0.05)
    assert not laws["coulomb"].tied
    assert laws["coulomb"].held_out_rms > 3.0 * noise_rms
    # The selected one of tied laws is that with the smallest number of parameters.
    assert all(law.parameters >= laws["stribeck"].parameters for law in found.laws if law.tied)
    assert found.to_dict()["laws"][0]["law"] == "stribeck"


@pytest.mark.extended
def test_offset_of_the_sensor_does_not_change_the_selected_law() -> None:
    found = diagnosis_with_offset("auto", 20.0)
    assert (found.model.law, found.effects) == ("stribeck", ("sensor_offset",))
    assert found.laws[0].held_out_rms == pytest.approx(0.2, rel=0.05)


@pytest.mark.extended
def test_simpler_law_is_reported_if_it_replaces_two_effects() -> None:
    """The offset remains an effect, because no law contains one."""
    found = diagnosis_with_offset("coulomb", 20.0)
    assert set(found.effects) == {"sensor_offset", "stribeck_excess"}
    assert found.laws == ()
    assert found.simpler_law is not None
    assert found.simpler_law.law == "stribeck"
    assert found.simpler_law.held_out_rms == pytest.approx(0.2, rel=0.05)


@pytest.mark.extended
def test_no_simpler_law_is_reported_if_it_replaces_one_effect() -> None:
    found = diagnosis_with_offset("coulomb", 0.0)
    assert (found.effects, found.simpler_law) == (("stribeck_excess",), None)


def slide_runs(friction_n: Callable[[Array], Array]) -> list[Run]:
    """Four runs of a slide of 4 kg with two sinusoids of velocity each, and white noise."""
    noise, time_s = np.random.default_rng(7), np.arange(0.0, 4.0, 0.01)
    runs = []
    for phase, (amplitude, rate) in enumerate(((0.1, 2.0), (0.3, 1.0), (0.6, 2.0), (0.5, 4.0))):
        sines = (np.sin(rate * time_s), 0.4 * np.sin(2.3 * rate * time_s + phase))
        slopes = (np.cos(rate * time_s), 0.92 * np.cos(2.3 * rate * time_s + phase))
        velocity = amplitude * np.sum(sines, axis=0)
        acceleration = amplitude * rate * np.sum(slopes, axis=0)
        force = friction_n(velocity) + 4.0 * acceleration
        force += 0.1 * noise.standard_normal(len(time_s))
        runs.append(Run.from_arrays(time_s, velocity, force, name=f"run {phase}"))
    return runs


def test_viscous_thinning_is_named_although_a_stribeck_curve_that_rises_fits_as_well() -> None:
    """The curves 30 v / (1 + v/0.4) and A (1 - exp(-(v/v_s)^delta)) + F_v v are similar."""
    runs = slide_runs(lambda v: 5.0 * np.sign(v) + 30.0 * v / (1.0 + np.abs(v) / 0.4))
    found = diagnose(Rig(drive=Drive("linear", "force")), runs, law="auto")
    assert (found.model.law, found.effects) == ("coulomb", ("viscous_thinning",))
    assert found.fit.parameters["F_v"].value == pytest.approx(30.0, rel=0.01)


@pytest.mark.extended
def test_stribeck_curve_that_rises_is_selected_if_no_effect_predicts_as_well() -> None:
    """Friction of way lubricants increases from rest to a higher level within a small speed."""
    runs = slide_runs(
        lambda v: np.sign(v) * (8.0 - 4.0 * np.exp(-np.abs(v) / 0.05)) + 6.0 * v,
    )
    found = diagnose(Rig(drive=Drive("linear", "force")), runs, law="auto")
    assert (found.verdict, found.model.law) == ("adequate", "stribeck")
    values = {name: found.fit.parameters[name].value for name in ("F_c", "F_s", "F_v")}
    assert values == pytest.approx({"F_c": 8.0, "F_s": 4.0, "F_v": 6.0}, rel=0.03)


def test_diagnoses_are_compared_with_the_own_delay_of_each_run() -> None:
    """Without a correction, these delays increase the error thirtyfold."""
    campaign = reversing_campaign((0.0, 0.02, -0.012))
    found = diagnose(Rig(), [p.run for p in campaign.prepared], law="coulomb")
    assert (
        held_out_rms_of_diagnoses([found, found], campaign)
        == [pytest.approx(NOISE_N, rel=0.05)] * 2
    )


def sweeping(force: Callable[[Array], Array], noise_rms: float) -> list[Run]:
    """Three runs with speeds of up to 0.4, 0.8 and 1.5 m/s."""
    runs, time = [], 0.02 * np.arange(500)
    for k, top in enumerate((0.4, 0.8, 1.5)):
        speed = top * (0.7 * np.sin(0.9 * time + k) + 0.3 * np.sin(2.3 * time))
        noise = np.random.default_rng(k).normal(scale=noise_rms, size=len(time))
        runs.append(Run.from_arrays(time, speed, force(speed) + noise, name=f"run{k}"))
    return runs


def with_quadratic_drag(v: Array) -> Array:
    """Coulomb and viscous friction with a quadratic drag.

    Without the drag, a Stribeck curve fits better than a straight line.
    """
    return np.asarray(0.25 * np.sign(v) + 0.1 * v + 0.7 * v * np.abs(v))


def test_simplest_law_is_selected_by_default_if_it_predicts_as_well_with_the_same_effects() -> None:
    found = diagnose(Rig(), sweeping(with_quadratic_drag, 0.03))
    assert (found.model.law, found.effects) == ("coulomb", ("quadratic_drag",)), found.summary()
    held_out = {law.law: law.held_out_rms for law in found.laws}
    assert held_out["stribeck"] < held_out["coulomb"]


@pytest.mark.extended
def test_limit_reached_while_the_simplest_law_is_compared_keeps_the_answer() -> None:
    now_s = [0.0]

    def progress(message: str, done: int, total: int) -> None:
        if SIMPLER_LAWS in message:
            now_s[0] = 2e3

    limit = TimeLimit(1e3, lambda: now_s[0])
    runs = sweeping(with_quadratic_drag, 0.03)
    found = diagnose(Rig(), runs, law="auto", progress=progress, time_limit_s=limit)
    assert (found.model.law, found.model.effects) == ("stribeck", ("quadratic_drag",))
    assert SIMPLER_LAWS in found.unfinished


def test_corrections_of_the_formula_of_a_larger_effect_are_not_named() -> None:
    """Carreau's equation differs from the formula of `viscous_thinning` by a few per cent."""

    def force(v: Array) -> Array:
        return np.asarray(18.0 * np.sign(v) + 60.0 * v * (1.0 + (v / 0.25) ** 2) ** -0.35)

    found = diagnose(Rig(), sweeping(force, 0.3), law="coulomb")
    assert found.effects == ("viscous_thinning",), found.summary()
    assert "quadratic_drag" in found.confounders
    assert len(set(found.confounders)) == len(found.confounders)
    assert found.steps[-1].held_out_rms < 0.33
