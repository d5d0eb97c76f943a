"""An interrupt (Ctrl-C) of a fit or a diagnosis returns the best model so far; exit code 130.

The interrupt comes from an effect written in Python, at a chosen evaluation of its force, or from
the progress callback.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import jbf
import numpy as np
import pytest
from by_hand import coulomb, four_runs
from jbf import Parameter, Rig
from jbf.cli import main
from jbf.diagnosis.one_round import one_round
from jbf.errors import Stopped

RUNS = four_runs(lambda t, v, a: coulomb(t, v, a) + 2.0 * a, noise_n=0.1)
ZERO = Parameter("b_n", "N", lower=-9.0, upper=9.0, null=0.0, starts=(1.0,))
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


@pytest.fixture(autouse=True)
def forget() -> Iterator[None]:
    """Remove the effect that a test registers."""
    yield
    with suppress(jbf.InputError):
        jbf.forget_effect("stopping")


def register(at: float) -> list[int]:
    """Register an offset that interrupts at one evaluation; return the counter of evaluations."""
    calls = [0]

    def stopping(time_s: np.ndarray, b_n: float) -> np.ndarray:
        calls[0] += 1
        if calls[0] == at:
            raise KeyboardInterrupt
        return b_n * np.ones(len(time_s))

    jbf.register_effect(stopping, parameters=[ZERO])
    return calls


def fit() -> jbf.Fit:
    return jbf.fit(Rig(), RUNS, ["inertia_leak", "stopping"], law="coulomb")


def test_fit_interrupted_at_its_first_evaluation_raises_a_plain_keyboard_interrupt() -> None:
    register(1)
    with pytest.raises(KeyboardInterrupt) as interrupted:
        fit()
    assert not isinstance(interrupted.value, Stopped)


def test_interrupted_fit_returns_the_best_parameters_so_far() -> None:
    calls = register(np.inf)
    complete = fit()
    total = calls[0]
    rms_n = []
    for at in (total // 8, total // 2):
        register(at)
        with pytest.raises(Stopped) as stopped:
            fit()
        best = stopped.value.fit
        assert not best.converged
        assert best.message == "interrupted"
        rms_n.append(best.rms_n)
    assert rms_n[0] >= rms_n[1] >= 0.999 * complete.rms_n


def stop_when(condition: Callable[[str, int, int], bool]) -> Callable[[str, int, int], None]:
    """A progress callback that raises `KeyboardInterrupt` when the condition holds."""

    def progress(message: str, done: int, total: int) -> None:
        if condition(message, done, total):
            raise KeyboardInterrupt

    return progress


def test_diagnosis_interrupted_while_trying_effects_returns_the_fitted_base_law() -> None:
    progress = stop_when(lambda message, done, total: total > 0)
    with pytest.raises(Stopped) as stopped:
        jbf.diagnose(Rig(), RUNS, law="coulomb", progress=progress)
    best = stopped.value.fit
    assert best.model.effects == ()
    expected = jbf.fit(Rig(), RUNS, law="coulomb")
    assert best.rms_n == pytest.approx(expected.rms_n, rel=0.05)


@pytest.mark.extended
def test_interrupted_round_returns_the_model_with_its_effects() -> None:
    progress = stop_when(lambda message, done, total: total > 0)
    with pytest.raises(Stopped) as stopped:
        one_round(Rig(), RUNS, ["inertia_leak"], law="coulomb", progress=progress)
    assert stopped.value.fit.model.effects == ("inertia_leak",)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "runs").mkdir()
    for run in RUNS:
        run.write_csv(tmp_path / "runs" / f"{run.name}.csv")
    (tmp_path / "runs" / "rig.toml").write_text('[drive]\nmotion = "linear"\nfriction = "force"\n')
    return tmp_path


def write_effect(at: int) -> None:
    Path("own.py").write_text(FILE.format(at=at))


@pytest.mark.parametrize(
    "command",
    ["diagnose runs --report r.html", "fit runs --effects stopping"],
    ids=["diagnose", "fit"],
)
def test_interrupted_command_writes_the_best_model_and_exits_with_code_130(
    command: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    at = 1
    if command.startswith("fit"):
        calls = register(np.inf)
        jbf.fit(Rig(), RUNS, ["stopping"], law="coulomb")
        at = calls[0] // 2
    write_effect(at)
    options = ["--law", "coulomb", "--effects-from", "own.py", "--out", "m.toml"]
    assert main([*command.split(), *options]) == 130
    printed = capsys.readouterr()
    assert printed.err.startswith("jbf: interrupted; the best so far is coulomb")
    assert printed.err.endswith("written to m.toml, not finished\n")
    assert printed.err.count("\n") == 1
    assert printed.out == ""
    assert not Path("r.html").exists()
    assert jbf.Model.load("m.toml").law == "coulomb"


def test_interrupted_diagnosis_without_an_output_file_prints_the_best_model(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_effect(1)
    assert main(["diagnose", "runs", "--law", "coulomb", "--effects-from", "own.py"]) == 130
    printed = capsys.readouterr()
    assert "F_c" in printed.out
    assert "best so far is coulomb, RMS" in printed.err
