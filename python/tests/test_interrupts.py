"""Ctrl-C keeps what there is: the best fit so far, told, with exit code 130."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import jbf
import pytest
from jbf import Fit, Rig, Run
from jbf.cli import main
from jbf.diagnosis import one_round, rounds
from jbf.errors import Stopped
from jbf.estimation.problem import Problem


@pytest.fixture
def stops_after(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[int], None]]:
    """Lets a search take so many steps, and interrupts the next; then all go on."""
    rows = Problem.gauss_newton_rows
    left: list[int] = []

    def counted(self: Problem, *arguments: object) -> object:
        if left:
            left[0] -= 1
            if left[0] < 0:
                left.clear()
                raise KeyboardInterrupt
        return rows(self, *arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(Problem, "gauss_newton_rows", counted)
    yield left.append
    left.clear()


def test_an_interrupted_fit_has_the_best_so_far(
    stops_after: Callable[[int], None], rig: Rig, runs: list[Run], bare_fit: Fit
) -> None:
    stops_after(0)
    with pytest.raises(KeyboardInterrupt) as nothing:
        jbf.fit(rig, runs)
    assert not isinstance(nothing.value, Stopped)
    errors = []
    for steps in (1, 8):
        stops_after(steps)
        with pytest.raises(Stopped) as stopped:
            jbf.fit(rig, runs)
        found = stopped.value.fit
        assert not found.converged
        assert found.message == "interrupted"
        errors.append(found.rms_n)
    assert errors[0] > errors[1] >= 0.999 * bare_fit.rms_n


def interrupted_at(round_: int, monkeypatch: pytest.MonkeyPatch) -> None:
    tried = rounds.try_candidates
    calls = []

    def once(*arguments: object) -> object:
        calls.append(1)
        if len(calls) > round_:
            raise KeyboardInterrupt
        return tried(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(rounds, "try_candidates", once)


def test_an_interrupted_diagnosis_has_the_model_of_its_round(
    monkeypatch: pytest.MonkeyPatch, rig: Rig, runs: list[Run], bare_fit: Fit
) -> None:
    interrupted_at(0, monkeypatch)
    with pytest.raises(Stopped) as first:
        jbf.diagnose(rig, runs)
    assert first.value.fit.model.effects == ()
    assert first.value.fit.rms_n == pytest.approx(bare_fit.rms_n, rel=0.05)


def test_an_interrupted_round_by_hand_has_its_model(
    monkeypatch: pytest.MonkeyPatch, rig: Rig, runs: list[Run]
) -> None:
    def interrupted(*_: object) -> object:
        raise KeyboardInterrupt

    monkeypatch.setattr(one_round, "try_candidates", interrupted)
    with pytest.raises(Stopped) as stopped:
        one_round.one_round(rig, runs, ["coulomb_drag"])
    assert stopped.value.fit.model.effects == ("coulomb_drag",)


def test_the_command_writes_the_best_and_says_so(
    campaign: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    interrupted_at(1, monkeypatch)
    out, page = campaign / "m.toml", campaign / "r.html"
    command = ["diagnose", str(campaign / "rig.toml"), str(campaign / "runs")]
    assert main([*command, "--out", str(out), "--report", str(page)]) == 130
    said = capsys.readouterr()
    assert said.err.startswith(
        "jbf: interrupted; the best so far is journal + coulomb_drag, RMS 0.3"
    )
    assert said.err.endswith(f"written to {out}, not finished\n")
    assert said.out == ""
    assert jbf.Model.load(out).effects == ("coulomb_drag",)
    assert not page.exists()


def test_without_a_file_the_best_is_printed(
    campaign: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    interrupted_at(0, monkeypatch)
    assert main(["diagnose", str(campaign / "rig.toml"), str(campaign / "runs")]) == 130
    said = capsys.readouterr()
    assert "f_m" in said.out
    assert "best so far is journal, RMS" in said.err


def test_an_interrupted_fit_of_the_command_is_written(
    campaign: Path, stops_after: Callable[[int], None], capsys: pytest.CaptureFixture[str]
) -> None:
    stops_after(8)
    out = campaign / "m.toml"
    command = ["fit", str(campaign / "rig.toml"), str(campaign / "runs"), "--out", str(out)]
    assert main(command) == 130
    assert "best so far is journal, RMS" in capsys.readouterr().err
    assert jbf.Model.load(out).law == "journal"
