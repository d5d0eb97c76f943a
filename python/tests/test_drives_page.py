"""docs/drives.md runs as it stands, and says what comes out."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import jbf
import pytest
from jbf.cli import main
from jbf.records.drive import Drive
from jbf.records.drive_columns import DriveColumns

PAGE = Path(__file__).resolve().parents[2] / "docs" / "drives.md"


def blocks(kind: str) -> list[str]:
    text = PAGE.read_text(encoding="utf-8")
    return re.findall(rf"```{kind}\n(.*?)```", text, flags=re.DOTALL)


def run(snippet: str) -> dict[str, object]:
    names: dict[str, object] = {}
    exec(compile(snippet, PAGE.name, "exec"), names)
    return names


def test_the_page_runs_as_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    written, read = blocks("python")
    (rig,) = blocks("toml")
    (commands,) = blocks("sh")
    run(written)
    Path("joint/rig.toml").write_text(rig)
    for line in commands.splitlines():
        assert main(shlex.split(line)[1:]) == 0, line
    said = capsys.readouterr().out
    for shown in blocks("text"):
        for line in shown.splitlines():
            assert " ".join(line.split()) in " ".join(said.split()), line
    for name in ("compare.html", "report.html", "model.toml"):
        assert Path(name).stat().st_size > 0
    assert Path("torque.csv").read_text().startswith("time_s,torque_n_m\n")
    run(read)
    assert re.fullmatch(r"15\.81\d* N m s/rad\n", capsys.readouterr().out)


def test_the_page_names_every_key_and_column() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for name in Drive.__dataclass_fields__:
        assert f"`{name}`" in text, name
    drives = (
        Drive("rotary", "torque"),
        Drive("rotary", "current", torque_constant_n_m_a=1.0),
        Drive("rotary", "percent", rated_torque_n_m=1.0),
        Drive("linear", "force", pitch_m=0.01),
        Drive("linear", "percent", rated_force_n=1.0),
    )
    for drive in drives:
        for column in DriveColumns.of(drive).known:
            assert f"`{column}`" in text, column


def test_the_page_names_only_effects_that_go_with_a_drive() -> None:
    section = PAGE.read_text(encoding="utf-8").partition("## What the effects are here")[2]
    rows = re.findall(r"^\| (`.*?) \|", section, flags=re.MULTILINE)
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    known = jbf.effects()
    assert named
    for name in named:
        assert "coulomb" not in known[name].refused
    # What only drives have stands there without exception.
    assert {name for name, page in known.items() if "journal" in page.refused} <= named
