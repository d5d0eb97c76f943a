"""Structured Text: parsed by blark, run by an interpreter and compared with the core."""

import jbf
import numpy as np
import pytest
import structured_text
from equation_models import model_of, models_with_many_effects, runs_with_all_columns
from jbf import export
from jbf.export.equations import LAWS
from joint_runs import JOINT

pytest.importorskip("blark", reason="needs blark: pip install blark")
CYCLE_S = 0.01


def run_block(exported: export.Exported, run: jbf.Run) -> np.ndarray:
    """Force of the function block, called once a sample."""
    scope = structured_text.load(exported.text)
    block = scope["joint_friction"]()
    record = export.record(jbf.Model(JOINT, "coulomb"), run)
    kept = record.samples
    columns = {
        "velocity": record.velocity_m_s[kept],
        "acceleration": record.acceleration_m_s2[kept],
        "position": record.angle_rad[kept],
        "load": record.load_n[kept],
        "temperature": record.temperature_c[kept] if record.temperature_c is not None else None,
        "weight_offset": np.zeros(len(kept)),
    }
    inputs = {name: values for name, values in columns.items() if hasattr(block, name)}
    force = []
    for i, dt_s in enumerate(np.diff(run.time_s, prepend=run.time_s[0])):
        block.dt_s = float(dt_s)
        for name, values in inputs.items():
            setattr(block, name, float(values[i]))
        scope["run"](block)
        force.append(block.force)
    return np.array(force)


def check(model: jbf.Model) -> None:
    run = runs_with_all_columns(CYCLE_S)[0]
    run = run.select(np.arange(len(run)) < 620)  # with reversals, a stop and a rest
    exported = export.to(model, "st", [run])
    force, expected = run_block(exported, run), model.predict(run)
    # `predict` also ends a step where the motion stops or starts between two samples.
    differing = np.abs(force - expected) > 1e-9 * np.max(np.abs(expected))
    assert np.sum(differing) <= 4
    assert exported.ledger.term(model.law).status == "exact"
    assert exported.ledger.share < 1e-12


@pytest.mark.parametrize("law", LAWS)
def test_function_block_of_a_law_gives_the_numbers_of_the_core(law: str) -> None:
    check(model_of(law))


@pytest.mark.parametrize("model", models_with_many_effects(), ids=lambda model: model.law)
def test_function_block_with_effects_gives_the_numbers_of_the_core(model: jbf.Model) -> None:
    check(model)


def test_reset_starts_anew() -> None:
    run = runs_with_all_columns(CYCLE_S)[0]
    scope = structured_text.load(export.to(model_of("lugre"), "st", [run]).text)
    block = scope["joint_friction"]()
    block.dt_s = CYCLE_S
    forces = []
    for reset in (False, False, False, True):
        block.velocity, block.reset = 0.001, reset
        scope["run"](block)
        forces.append(block.force)
    assert forces[3] == forces[0]
    assert np.isfinite(forces).all()


def test_name_that_is_no_identifier_of_the_standard_is_refused() -> None:
    settings = export.Settings(joint="left__elbow")
    with pytest.raises(jbf.InputError):
        export.to(model_of("coulomb"), "st", runs_with_all_columns(0.02), settings=settings)
