"""Data frames, Arrow tables and mappings as runs."""

from __future__ import annotations

from contextlib import suppress
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf import InputError, Run

TIME = np.arange(0.0, 5.0, 0.02)
COLUMNS: dict[str, np.ndarray] = {
    "time_s": TIME,
    "velocity_m_s": 0.1 * np.sin(TIME),
    "friction_n": 3.0 * np.sign(np.sin(TIME)),
    "load_n": np.full(len(TIME), 50.0),
    "current_a": np.cos(TIME),
}
WORDS = ["a"] * len(TIME)


class Table:
    """An Arrow table's interface, as far as names and columns go."""

    def __init__(self, columns: dict[str, Any]) -> None:
        self._columns = columns
        self.column_names = list(columns)

    def __getitem__(self, name: str) -> Any:
        return SimpleNamespace(to_numpy=lambda: np.asarray(self._columns[name]))


def frames(columns: dict[str, Any]) -> dict[str, Any]:
    """The same columns in every kind of frame that is installed."""
    made: dict[str, Any] = {"mapping": columns, "table": Table(columns)}
    for library in ("pandas", "polars"):
        try:
            made[library] = __import__(library).DataFrame(columns)
        except ImportError:
            continue
    with suppress(ImportError):
        made["pyarrow"] = __import__("pyarrow").table(columns)
    return made


@pytest.mark.parametrize("kind", ["mapping", "table", "pandas", "polars", "pyarrow"])
def test_a_frame_is_the_run_of_its_columns(kind: str) -> None:
    made = frames(COLUMNS | {"note": WORDS})
    if kind not in made:
        pytest.skip(f"{kind} is not installed")
    run = Run.from_frame(made[kind], name="a")
    known = {name: a for name, a in COLUMNS.items() if name not in ("time_s", "current_a")}
    expected = Run.from_arrays(TIME, **known, extra={"current_a": COLUMNS["current_a"]}, name="a")
    assert run.to_csv() == expected.to_csv()


def test_an_index_tells_the_time() -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(COLUMNS).set_index("time_s")
    assert Run.from_frame(frame).to_csv() == Run.from_frame(COLUMNS).to_csv()


@pytest.mark.parametrize("kind", ["mapping", "table", "pandas", "polars", "pyarrow"])
def test_what_is_missing_is_a_clock_of_its_own(kind: str) -> None:
    force: list[float | None] = [
        f if i % 3 == 1 else None for i, f in enumerate(COLUMNS["friction_n"])
    ]
    made = frames(
        {name: COLUMNS[name] for name in ("time_s", "velocity_m_s")} | {"friction_n": force}
    )
    if kind not in made:
        pytest.skip(f"{kind} is not installed")
    run = Run.from_frame(made[kind])
    np.testing.assert_array_equal(
        np.flatnonzero(run.read["friction_n"]), np.arange(1, len(TIME), 3)
    )


def test_few_missing_values_are_refused() -> None:
    force = COLUMNS["friction_n"].copy()
    force[7] = np.nan
    with pytest.raises(InputError, match="friction_n: sample 7: nan is not a finite number"):
        Run.from_frame(COLUMNS | {"friction_n": force})


@pytest.mark.parametrize(
    ("frame", "says"),
    [
        (3.0, "float has no columns by name"),
        ([1.0, 2.0], "list has no columns by name"),
        ({"velocity_m_s": TIME}, "column time_s: is missing; call a column so"),
    ],
)
def test_what_is_no_frame_is_one_line(frame: object, says: str) -> None:
    with pytest.raises(InputError, match=says):
        Run.from_frame(frame)


def test_masked_samples_are_not_used() -> None:
    force = np.ma.array(COLUMNS["friction_n"], mask=TIME > 4.0)
    with pytest.raises(InputError, match="column friction_n: has masked samples"):
        Run.from_arrays(TIME, COLUMNS["velocity_m_s"], force)
    # A mask that hides nothing is none.
    whole = np.ma.array(COLUMNS["friction_n"], mask=False)
    assert len(Run.from_arrays(TIME, COLUMNS["velocity_m_s"], whole)) == len(TIME)
