"""Parts of a model's friction: what effects add, and what of it the rest could not make up for."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import LAW, coulomb, there_and_back
from jbf import Comparison, Model, ParameterValue, Rig, Run, compare
from jbf.comparison.over_speed import friction_over_speed
from jbf.comparison.parts import added_by, beside_friction, friction_alone, made_of
from jbf.errors import FilmWarning

Array = npt.NDArray[np.float64]
OFFSET = {"sensor_offset.b_n": 2.0}
DRIFT = {"sensor_drift.d_n_s": 0.5}
HELD_STATIC = {"F_s_n": ParameterValue(5.0, None, held=True)}


def model_of(effects: list[str], **own: ParameterValue | float) -> Model:
    return Model(Rig(), "coulomb", effects, {**LAW, **HELD_STATIC, **own})


@pytest.fixture(scope="module")
def runs() -> list[Run]:
    return there_and_back(lambda t, v, a: coulomb(t, v, a) + 2.0 + 0.5 * t)


@pytest.fixture(scope="module")
def bare(runs: list[Run]) -> Comparison:
    return compare(model_of([]), runs)


@pytest.fixture(scope="module")
def full(runs: list[Run]) -> Comparison:
    return compare(model_of(["sensor_offset", "sensor_drift"], **OFFSET, **DRIFT), runs)


# ---- what effects add --------------------------------------------------------------------------


def test_an_offset_adds_itself_and_both_add_their_sum(full: Comparison) -> None:
    drift = added_by(full, ["sensor_drift"])
    assert [np.ptp(d) for d in drift] == pytest.approx([5.0, 5.0])
    for offset, both, d in zip(
        added_by(full, ["sensor_offset"]), added_by(full, full.model.effects), drift, strict=True
    ):
        assert offset == pytest.approx(np.full(501, 2.0))
        assert both == pytest.approx(2.0 + d)


def test_what_a_model_does_not_have_adds_nothing_whatever_it_predicts(full: Comparison) -> None:
    """No model is asked for it: of predictions that are off by a newton nothing is its."""
    off = replace(full, predictions=[p + 1.0 for p in full.predictions])
    assert [a.tolist() for a in added_by(off, ["sensor_lag"])] == [[0.0] * 501] * 2
    assert added_by(off, ["sensor_offset", "sensor_lag"])[0] == pytest.approx(np.full(501, 3.0))


def test_a_fast_film_is_warned_of_once_by_the_whole_model() -> None:
    """The model without an effect says no more of it."""
    t = np.arange(0.0, 10.0, 0.02)
    v = 0.02 * np.sin(2.0 * np.pi * t)
    run = Run.from_arrays(t, v, 20.0 * np.sign(v), name="quick")
    law = {"U_tr_m_s": 0.055, "K0": 4e3, "gamma": 33.0, "f_m": 0.26}
    model = Model(Rig.thesis(), effects=["sensor_offset"], parameters=law | OFFSET)
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        compared = compare(model, [run])
        first = len([w for w in seen if issubclass(w.category, FilmWarning)])
        added_by(compared, ["sensor_offset"])
        assert len([w for w in seen if issubclass(w.category, FilmWarning)]) == first


def test_friction_alone_is_the_reading_without_what_is_none(full: Comparison) -> None:
    for found, p in zip(friction_alone(full), full.campaign.prepared, strict=True):
        v = p.motion.velocity_m_s
        assert found == pytest.approx(5.0 * np.sign(v) + 20.0 * v, abs=2e-3)


def test_what_is_beside_friction_comes_in_one_order(full: Comparison) -> None:
    assert beside_friction(full) == ("sensor_offset", "sensor_drift")


def test_each_run_has_a_prediction(bare: Comparison, full: Comparison) -> None:
    """A run that is missing somewhere is not left out without a word."""
    short = replace(full, predictions=full.predictions[:1])
    with pytest.raises(ValueError, match="zip"):
        added_by(short, ["sensor_offset"])
    lacking = replace(bare, predictions=bare.predictions[:1])
    with pytest.raises(ValueError, match="zip"):
        friction_alone(lacking)
    with pytest.raises(ValueError, match="zip"):
        friction_over_speed(lacking)
    less = replace(bare, samples=replace(bare.samples, counted=bare.samples.counted[:1]))
    with pytest.raises(ValueError, match="zip"):
        made_of(less, full)


# ---- what of it the rest could not say ---------------------------------------------------------


def left_over(
    added: list[Array], ways: list[Array], counted: list[npt.NDArray[np.bool_]]
) -> list[Array]:
    """What of it columns cannot make up for, where samples count."""
    flat = np.concatenate([a[c] for a, c in zip(added, counted, strict=True)])
    rows = np.concatenate([w[c] for w, c in zip(ways, counted, strict=True)])
    share = np.linalg.lstsq(rows, flat, rcond=None)[0]
    return [a - w @ share for a, w in zip(added, ways, strict=True)]


@pytest.mark.parametrize("free", [("F_c_n", "F_v_n_s_m"), ("F_c_n",), ("F_v_n_s_m",)])
def test_an_effect_makes_what_the_laws_free_parameters_cannot(
    full: Comparison, runs: list[Run], free: tuple[str, ...]
) -> None:
    """Dry friction is the sign of the speed, viscous friction the speed; a held one gives no way.

    Only samples that count say what the law can make up for.
    """
    held = {n: ParameterValue(x, None, held=n not in free) for n, x in LAW.items()}
    before = compare(model_of([], **held), runs)
    masks = [np.arange(501) < 400, np.arange(501) >= 250]
    before = replace(before, samples=before.samples.within(masks))
    motions = [p.motion.velocity_m_s for p in before.campaign.prepared]
    ways = {"F_c_n": [np.sign(v) for v in motions], "F_v_n_s_m": motions}
    columns = [np.column_stack(pair) for pair in zip(*(ways[n] for n in free), strict=True)]
    found = made_of(before, full)
    assert list(found) == ["sensor_offset", "sensor_drift"]
    for name, parts in found.items():
        wanted = left_over(added_by(full, [name]), columns, masks)
        for part, there in zip(parts, wanted, strict=True):
            assert part == pytest.approx(there, abs=5e-3)


def test_where_nothing_is_new_nothing_is_made(bare: Comparison, full: Comparison) -> None:
    assert made_of(full, bare) == {}
    assert made_of(full, full) == {}


def test_a_parameter_that_moves_nothing_takes_nothing(full: Comparison, runs: list[Run]) -> None:
    """A drag that is not there has no derivative by where it fades."""
    before = compare(model_of([]), runs)
    wanted = made_of(before, full)["sensor_offset"]
    idle = compare(model_of([], F_s_n=ParameterValue(5.0, 0.1)), runs)
    for found, there in zip(made_of(idle, full)["sensor_offset"], wanted, strict=True):
        assert np.all(np.isfinite(found))
        assert found == pytest.approx(there, abs=5e-3)
