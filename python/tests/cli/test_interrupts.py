"""An interrupt (Ctrl-C) of a fit or a diagnosis returns the best model so far; exit code 130.

The interrupt comes from an effect written in Python, at a chosen evaluation of its force, or from
the progress callback.
"""

from pathlib import Path
from typing import Any

import jbf
import pytest
from by_hand import coulomb, four_runs
from input_checks import Capture
from jbf import Rig
from jbf.cli import main
from jbf.diagnosis.manual_round import manual_round
from jbf.errors import Stopped

RUNS = four_runs(lambda t, v, a: coulomb(t, v, a) + 2.0 * a, noise_rms=0.1)
FILE = """\
import jbf
import numpy as np

calls = 0

def stopping(time_s, b_n):
    global calls
    calls += 1
    if calls == {at}:
        raise KeyboardInterrupt
    return b_n * np.ones(len(time_s))

zero = jbf.Parameter("b_n", "N", lower=-9.0, upper=9.0, null=0.0, starts=(1.0,))
jbf.register_effect(stopping, parameters=[zero])
"""


FIT = "fit runs --effects stopping"
pytestmark = pytest.mark.usefixtures("forget_user_effects")


def register(at: int) -> dict[str, Any]:
    """Register an offset that interrupts at evaluation `at`; return its module with the counter."""
    module: dict[str, Any] = {}
    exec(FILE.format(at=at), module)
    return module


def fit() -> jbf.Fit:
    start = {"inertia.m_e": 30.0}
    return jbf.fit(Rig(), RUNS, ["inertia", "stopping"], law="coulomb", start=start)


def test_fit_interrupted_at_first_evaluation_raises_plain_keyboard_interrupt() -> None:
    register(1)
    with pytest.raises(KeyboardInterrupt) as interrupted:
        fit()
    assert not isinstance(interrupted.value, Stopped)


def test_interrupted_fit_returns_the_best_parameters_so_far() -> None:
    module = register(0)
    complete = fit()
    total, rms = module["calls"], []
    # The search begins before the first of these evaluations and ends after the second.
    for at in (total // 48, total // 2):
        register(at)
        with pytest.raises(Stopped) as stopped:
            fit()
        best = stopped.value.fit
        assert (best.converged, best.message) == (False, "interrupted")
        rms.append(best.rms)
    assert rms[0] > rms[1] >= 0.999 * complete.rms


def stop_at_candidates(message: str, done: int, total: int) -> None:
    """A progress callback that interrupts when the first candidate is tried."""
    if total > 0:
        raise KeyboardInterrupt


def test_diagnosis_interrupted_while_trying_effects_returns_the_fitted_base_law() -> None:
    with pytest.raises(Stopped) as stopped:
        jbf.diagnose(Rig(), RUNS, law="coulomb", progress=stop_at_candidates)
    best = stopped.value.fit
    assert best.model.effects == ()
    expected = jbf.fit(Rig(), RUNS, law="coulomb")
    assert best.rms == pytest.approx(expected.rms, rel=0.05)


@pytest.mark.extended
def test_interrupted_round_of_candidates_returns_the_model_with_its_effects() -> None:
    with pytest.raises(Stopped) as stopped:
        manual_round(Rig(), RUNS, ["inertia"], law="coulomb", progress=stop_at_candidates)
    assert stopped.value.fit.model.effects == ("inertia",)


@pytest.fixture
def folder(working_folder: Path) -> None:
    """Write the runs and a rig into the folder `runs`."""
    Path("runs").mkdir()
    for run in RUNS:
        run.write_csv(f"runs/{run.name}.csv")
    Path("runs/rig.toml").write_text('[drive]\nmotion = "linear"\nfriction = "force"\n')


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("command", ["diagnose runs --report r.html", FIT])
def test_interrupted_command_writes_model_and_exits_with_130(command: str, capsys: Capture) -> None:
    at = 1
    if command.startswith("fit"):
        module = register(0)
        jbf.fit(Rig(), RUNS, ["stopping"], law="coulomb")
        at = module["calls"] // 2
    Path("own.py").write_text(FILE.format(at=at))
    options = ["--law", "coulomb", "--effects-from", "own.py", "--out", "m.toml"]
    assert main([*command.split(), *options]) == 130
    printed = capsys.readouterr()
    assert printed.err.startswith("jbf: interrupted; the best model so far is coulomb")
    assert printed.err.endswith("written to m.toml, not finished\n")
    assert printed.err.count("\n") == 1
    assert printed.out == ""
    assert not Path("r.html").exists()
    assert jbf.Model.load("m.toml").law == "coulomb"


@pytest.mark.usefixtures("folder")
def test_interrupted_diagnosis_prints_model_if_no_file_is_given(capsys: Capture) -> None:
    Path("own.py").write_text(FILE.format(at=1))
    assert main(["diagnose", "runs", "--law", "coulomb", "--effects-from", "own.py"]) == 130
    printed = capsys.readouterr()
    assert "F_c" in printed.out
    assert "best model so far is coulomb" in printed.err
