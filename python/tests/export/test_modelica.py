"""Modelica: simulated by Rumoca and compared with the core."""

import re
from pathlib import Path

import jbf
import numpy as np
import pytest
from equation_models import model_of, models_with_many_effects, runs_with_all_columns
from jbf import export
from jbf.export.drive_equations import DRIVE
from jbf.export.equations import LAWS
from joint_runs import joint_runs

SWITCHING = ("seven_parameter", "dwell_stiction", *DRIVE)
"""Laws and effects whose state is not a differential equation."""
rumoca = pytest.importorskip("rumoca", reason="needs rumoca: pip install rumoca")


def short_runs() -> list[jbf.Run]:
    """Run with reversals, of the length that Rumoca simulates quickly."""
    run = runs_with_all_columns(0.005)[0]
    return [run.select(np.arange(len(run)) < 600)]


@pytest.mark.parametrize("law", [law for law in LAWS if law not in SWITCHING])
def test_package_of_a_law_follows_the_core_in_rumoca(law: str) -> None:
    ledger = export.to(model_of(law), "modelica", short_runs()).ledger
    assert "Rumoca" in ledger.evaluated_by
    assert ledger.term(law).status == "exact"
    assert ledger.share < 1e-3


@pytest.mark.parametrize("model", models_with_many_effects(SWITCHING), ids=lambda model: model.law)
def test_package_with_effects_follows_the_core_in_rumoca(model: jbf.Model) -> None:
    ledger = export.to(model, "modelica", short_runs()).ledger
    assert "simulated by Rumoca" in ledger.evaluated_by
    assert ledger.share < 1e-3


@pytest.mark.parametrize(
    "model", [model_of("seven_parameter"), model_of("lugre", "dwell_stiction")]
)
def test_state_that_switches_is_refused(model: jbf.Model) -> None:
    with pytest.raises(jbf.InputError, match="Co-Simulation"):
        export.to(model, "modelica", short_runs())


@pytest.mark.parametrize("law", ["stribeck", "lugre"])
def test_example_of_a_package_simulates_with_the_force_of_the_core(law: str) -> None:
    model = model_of(law)
    exported = export.to(model, "modelica", joint_runs(step_s=0.02))
    assert rumoca.validate_source(exported.text) == []
    compiled = rumoca.Session().loads(exported.text, model="JointFriction.Example")
    result = compiled.simulate(t=(0.0, 0.9), dt=0.001)
    time_s, speed = np.asarray(result.time), np.asarray(result["friction.velocity"])
    run = jbf.Run.from_arrays(time_s, speed)
    expected = model.predict(run)
    force = np.asarray(result["friction.force"])
    slides = np.abs(speed) > 1e-3  # the instant of a jump is that of the solver
    error = np.sqrt(np.mean((force - expected)[slides] ** 2))
    assert error < 2e-3 * np.sqrt(np.mean(expected**2))


def test_packages_have_no_messages_in_rumoca() -> None:
    for model in models_with_many_effects(SWITCHING):
        text = export.to(model, "modelica", long_runs()).text
        assert rumoca.validate_source(text) == []


def long_runs() -> list[jbf.Run]:
    """Runs with more samples than an export simulates."""
    return runs_with_all_columns(0.001)[:1]


def test_mass_of_the_page_moves_with_the_block() -> None:
    page = Path(__file__).resolve().parents[3] / "docs" / "how" / "modelica.md"
    (arm,) = re.findall(r'```modelica title="Arm.mo"\n(.*?)```', page.read_text(), re.DOTALL)
    model = model_of("lugre", "inertia")
    settings = export.Settings(joint="elbow")
    text = export.to(model, "modelica", joint_runs(step_s=0.02), settings=settings).text
    compiled = rumoca.Session().loads(text + arm, model="Arm")
    result = compiled.simulate(t=(0.0, 6.0), dt=0.01)
    speed = np.asarray(result["w"])
    assert np.abs(speed[:50]).max() < 0.02  # below breakaway the bristle holds
    assert speed.max() > 0.5
