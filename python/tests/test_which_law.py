"""Which law at all: by prediction of runs left out, the simplest of those that predict alike."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jbf import Rig, Run, diagnose
from jbf.cli import main
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.which_law import allowed, compared
from numpy.typing import NDArray

Array = NDArray[np.float64]
NOISE_N = 0.2


def left(*sizes: float, samples: int = 4000) -> list[list[Array]]:
    """Errors of several models, N, one run each: the same noise, times a size."""
    e = np.random.default_rng(5).standard_normal(samples)
    return [[size * e] for size in sizes]


def test_the_best_comes_first_and_what_differs_clearly_is_not_tied() -> None:
    tried = compared(["a", "b", "c"], [3, 2, 5], left(1.3, 1.0, 1.003), DEFAULT)
    assert [t.law for t in tried] == ["b", "c", "a"]
    assert [t.tied for t in tried] == [True, True, False]
    assert tried[0].left_out_rms_n == pytest.approx(1.0, rel=0.05)
    strict = replace(DEFAULT, law_same=1.002)
    assert [t.tied for t in compared(["a", "b"], [3, 2], left(1.0, 1.003), strict)] == [True, False]


def test_what_differs_by_chance_is_tied() -> None:
    random = np.random.default_rng(8)
    rows = [[random.standard_normal(400)] for _ in range(2)]
    ratio = np.sqrt(np.mean(rows[1][0] ** 2) / np.mean(rows[0][0] ** 2))
    assert abs(ratio - 1.0) > 0.005
    assert all(t.tied for t in compared(["a", "b"], [1, 1], rows, DEFAULT))
    strict = replace(DEFAULT, law_tie=0.0)
    assert not all(t.tied for t in compared(["a", "b"], [1, 1], rows, strict))


def test_only_samples_that_count_for_every_law_are_compared() -> None:
    rows = left(1.0, 1.0)
    rows[0][0][:100] = 50.0
    rows[1][0][:100] = np.nan
    one, other = compared(["a", "b"], [1, 1], rows, DEFAULT)
    assert one.left_out_rms_n == other.left_out_rms_n < 1.1


def test_without_a_bearing_no_bearings_law_is_tried() -> None:
    assert "journal" not in allowed(Rig())
    assert {"coulomb", "stribeck"} <= set(allowed(Rig()))


def stribeck(v: Array) -> Array:
    """A Stribeck curve of its own, not the library's."""
    return np.sign(v) * (6.0 + 5.0 * np.exp(-((v / 0.01) ** 2)) + 30.0 * np.abs(v))


def runs(zero_n: float = 0.0) -> list[Run]:
    found = []
    for k, (top, period) in enumerate([(0.02, 4.0), (0.1, 3.0), (0.05, 2.5)]):
        t = np.arange(0.0, 24.0, 0.01)
        v = top * np.sin(2.0 * np.pi * t / period)
        noise = NOISE_N * np.random.default_rng(k).standard_normal(len(t))
        force = stribeck(v) + zero_n + noise
        found.append(Run.from_arrays(t, v, force, name=f"run {k}"))
    return found


def test_a_stribeck_record_gets_its_law_and_no_effect(tmp_path: Path) -> None:
    found = diagnose(Rig(), runs(), law="auto")
    # Nothing bends and nothing lags: the laws that have the same curve and more are tied at best.
    assert found.model.law == "stribeck" == found.laws[0].law
    assert (found.verdict, found.effects) == ("adequate", ())
    by_name = {t.law: t for t in found.laws}
    assert by_name["stribeck"].left_out_rms_n == pytest.approx(NOISE_N, rel=0.05)
    assert not by_name["coulomb"].tied
    assert by_name["coulomb"].left_out_rms_n > 3.0 * NOISE_N
    text = found.summary()
    assert "The data chose the law stribeck" in text
    assert "Which law, each beside a zero" in text
    assert found.to_dict()["laws"][0]["law"] == "stribeck"
    page = tmp_path / "d.html"
    found.save_html(page)
    assert "Which law, each beside a zero" in page.read_text()


def test_where_another_law_alone_does_better_that_is_said() -> None:
    found = diagnose(Rig(), runs(), law="seven_parameter")
    assert (found.verdict, found.laws) == ("unexplained", ())
    assert found.simpler_law is not None
    assert found.simpler_law.law == "stribeck"
    words = " ".join(found.summary().split())
    assert "Another law may be the right one: stribeck, which needs no other friction" in words
    # One effect that says it all is not worth a search.
    found = diagnose(Rig(), runs(), law="coulomb")
    assert (found.effects, found.simpler_law) == (("stribeck_excess",), None)


def test_what_is_no_friction_stays_beside_another_law() -> None:
    """Two effects that one law says, but for the zero that no law can say."""
    found = diagnose(Rig(), runs(zero_n=20.0), law="coulomb")
    assert found.effects == ("sensor_offset", "stribeck_excess")
    assert found.simpler_law is not None
    assert found.simpler_law.law == "stribeck"
    assert found.simpler_law.left_out_rms_n == pytest.approx(NOISE_N, rel=0.05)


def test_a_zero_does_not_choose_the_law() -> None:
    # Beside an offset that no law can say, the smallest differences would.
    found = diagnose(Rig(), runs(zero_n=20.0), law="auto")
    assert (found.model.law, found.effects) == ("stribeck", ("sensor_offset",))
    assert found.laws[0].left_out_rms_n == pytest.approx(NOISE_N, rel=0.05)


def test_the_winner_is_diagnosed() -> None:
    found = diagnose(Rig(), runs(zero_n=1.5), law="auto")
    assert (found.model.law, found.effects) == ("stribeck", ("sensor_offset",))


def test_the_command_takes_auto(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig, answer = tmp_path / "rig.toml", tmp_path / "d.json"
    rig.write_text("# a slide\n")
    names = []
    for run in runs():
        names.append(str(tmp_path / f"{run.name.replace(' ', '_')}.csv"))
        run.write_csv(names[-1])
    assert main(["diagnose", str(rig), *names, "--law", "auto", "--json", str(answer)]) == 0
    assert json.loads(answer.read_text())["law"] == "stribeck"
    assert "The data chose the law stribeck" in capsys.readouterr().out


def test_a_drive_without_a_law_takes_what_the_data_choose(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "rig.toml").write_text('[drive]\nmotion = "linear"\nfriction = "force"\n')
    for run in runs():
        run.write_csv(tmp_path / f"{run.name.replace(' ', '_')}.csv")
    assert main(["diagnose", str(tmp_path / "rig.toml"), str(tmp_path)]) == 0
    assert "The data chose the law stribeck" in capsys.readouterr().out
