"""Recordings of LinuxCNC: halscope writes a name with each value, halsampler does not."""

from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf.errors import InputError
from jbf.importing.formats.registry import open_source
from jbf.importing.guessed import Guess

N = 400
POSITION = np.round(5.0 * np.sin(np.arange(N) / 60.0), 6)
TORQUE = np.round(0.4 + 0.1 * np.cos(np.arange(N) / 60.0), 6)
MAP = """[file]
rate_hz = 1000
[columns]
position_m = "`{position}` [m]"
friction_n = "`{force}` [N]"
[drive]
motion = "linear"
friction = "force"
"""


def write_log(path: Path) -> None:
    """Write a log in the layout of halscope: the period, then name and value of each channel."""
    lines = ["Sampling period is 2000000 ns "]
    for position, torque in zip(POSITION.tolist(), TORQUE.tolist(), strict=True):
        lines.append(f"joint.0.motor-pos-fb {position:+.14f} drive.torque-fb {torque:+.14f} ")
    path.write_text("\n".join(lines))


def questions(guess: Guess) -> str:
    return "\n".join(map(str, guess.questions))


def test_halscope_log_has_the_names_of_its_pins_and_the_rate_of_its_period(tmp_path: Path) -> None:
    write_log(tmp_path / "scope.log")
    with open_source(tmp_path / "scope.log") as source:
        (table,) = source.tables
        head = source.head(table)
    assert [column.name for column in table.columns] == ["joint.0.motor-pos-fb", "drive.torque-fb"]
    assert table.rate_hz == 500.0
    np.testing.assert_array_equal(head["joint.0.motor-pos-fb"], POSITION)
    np.testing.assert_array_equal(head["drive.torque-fb"], TORQUE)


def test_missing_units_of_a_halscope_log_become_questions(tmp_path: Path) -> None:
    write_log(tmp_path / "scope.log")
    asked = questions(jbf.look(tmp_path / "scope.log"))
    assert "joint.0.motor-pos-fb: it has no unit" in asked
    assert "drive.torque-fb: it has no unit" in asked
    assert "time_s" not in asked


@pytest.mark.parametrize("tagged", [False, True])
def test_missing_columns_and_rate_of_halsampler_output_become_questions(
    tagged: bool, tmp_path: Path
) -> None:
    path = tmp_path / "sampler.txt"
    rows = [
        f"{f'{k} ' if tagged else ''}{p:.6f} {t:.6f} "
        for k, (p, t) in enumerate(zip(POSITION.tolist(), TORQUE.tolist(), strict=True))
    ]
    path.write_text("\n".join(rows) + "\n")
    asked = questions(jbf.look(path))
    assert "rate_hz" in asked
    assert "which column is the friction" in asked
    assert "which column is a position or a speed" in asked
    first = 2 if tagged else 1
    names = {"position": f"column {first}", "force": f"column {first + 1}"}
    (tmp_path / "map.toml").write_text(MAP.format(**names))
    (run,) = jbf.import_files(path, tmp_path / "map.toml", whole=True).runs
    np.testing.assert_array_equal(run.friction, TORQUE)
    np.testing.assert_array_equal(run.position_m, POSITION)
    np.testing.assert_allclose(run.time_s, np.arange(N) / 1000.0, rtol=1e-15)


@pytest.mark.parametrize("share", [0.0005, 0.003, 0.5, 0.98])
def test_truncated_halscope_log_returns_its_complete_samples_or_a_one_line_error(
    share: float, tmp_path: Path
) -> None:
    path = tmp_path / "scope.log"
    write_log(path)
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    if share < 0.003:
        with pytest.raises(InputError) as refused:
            open_source(path)
        assert "\n" not in str(refused.value)
        return
    with open_source(path) as source:
        head = source.head(source.tables[0])
    position = head["joint.0.motor-pos-fb"]
    np.testing.assert_array_equal(position[:-1], POSITION[: len(position) - 1])
