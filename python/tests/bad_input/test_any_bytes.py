"""Whatever bytes a file holds: a reader gives a value or an `InputError`, and comes to an end."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from bad_input.checking import MAP, MODEL, RIG, in_time, table
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from jbf import InputError, Model, Run, import_files, look, read_map, read_rig, read_run
from jbf.records.folder import read_campaign

TEXTS = {
    "csv": table(),
    "rig": RIG,
    "model": MODEL,
    "map": MAP + '[file]\ndelimiter = ","\nheader = 1\n[cut]\nby = "rests"\nrest_s = 1.0\n',
}
PIECES = (
    b"\0", b"\xff\xfe", b"\xef\xbb\xbf", b"\xb5", b"\r", b"\n", b",", b";", b"\t", b'"', b"'", b"#",
    b"nan", b"inf", b"-", b"1e308", b"5e-324", b"1e-300", b"9" * 400, b"0", b"[", b"]", b"[[", b"{",
    b"}", b"=", b".", b"?", b"`", b"(", b"true", b"1979-05-27", b"time_s", b"[rig]", b"\\u0000",
    b"()" * 200, b"/ 0", b"load_n",
)  # fmt: skip
"""What files are broken by."""

settings.register_profile(
    "bad input",
    deadline=None,
    derandomize=True,
    max_examples=100,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
few = settings(settings.get_profile("bad input"))
fewer = settings(few, max_examples=50)
"""Of readers that take a tenth of a second."""


@st.composite
def broken(draw: st.DrawFn, kind: str) -> bytes:
    """A good file with a few places cut out, doubled or written over."""
    data = TEXTS[kind].encode()
    for _ in range(draw(st.integers(1, 3))):
        first = draw(st.integers(0, len(data)))
        end = min(len(data), first + draw(st.integers(0, 12)))
        way = draw(st.integers(0, 3))
        if way == 0:
            data = data[:first] + draw(st.sampled_from(PIECES)) + data[end:]
        elif way == 1:
            data = data[:first] + data[end:]
        elif way == 2:
            data = data[:end] + data[first:]
        else:
            data = data[:first] + draw(st.binary(max_size=6)) + data[end:]
    return data


def content(kind: str) -> st.SearchStrategy[bytes]:
    return st.one_of(broken(kind), broken(kind), st.binary(max_size=200), st.text().map(_utf_8))


def _utf_8(text: str) -> bytes:
    return text.encode("utf-8", errors="surrogatepass")


def value_or_one_line(read: Callable[[], object]) -> object:
    """What a reader gives; None where it refuses, in one line."""
    try:
        with in_time():
            return read()
    except InputError as error:
        told = str(error)
    assert told
    assert not re.search(r"[\x00-\x1f\x7f-\x9f]", told)
    return None


@few
@given(content("csv"))
def test_any_run(folder: Path, data: bytes) -> None:
    (folder / "x.csv").write_bytes(data)
    run = value_or_one_line(lambda: read_run(folder / "x.csv"))
    if isinstance(run, Run):
        assert len(run) >= 10
        assert all(np.isfinite(values).all() for values in run.columns().values())
        assert (np.diff(run.time_s) > 0.0).all()


@few
@given(content("rig"))
def test_any_rig(folder: Path, data: bytes) -> None:
    (folder / "x.toml").write_bytes(data)
    rig = value_or_one_line(lambda: read_rig(folder / "x.toml"))
    if rig is not None:
        rig.write(folder / "y.toml")  # type: ignore[attr-defined]
        assert read_rig(folder / "y.toml") == rig


@few
@given(content("model"))
def test_any_model(folder: Path, data: bytes) -> None:
    (folder / "x.toml").write_bytes(data)
    model = value_or_one_line(lambda: Model.load(folder / "x.toml"))
    if isinstance(model, Model) and model.law == "coulomb":
        assert np.isfinite(model.predict(read_run(folder / "a.csv"))).all()


@few
@given(content("map"))
def test_any_map(folder: Path, data: bytes) -> None:
    (folder / "x.toml").write_bytes(data)
    if value_or_one_line(lambda: read_map(folder / "x.toml")) is not None:
        found = value_or_one_line(lambda: import_files(folder / "a.csv", folder / "x.toml"))
        runs = [] if found is None else found.runs  # type: ignore[attr-defined]
        for run in runs:
            assert np.isfinite(run.friction_n).all()


@fewer
@given(content("csv"))
def test_any_look(folder: Path, data: bytes) -> None:
    (folder / "x.csv").write_bytes(data)
    value_or_one_line(lambda: look(folder / "x.csv"))


@fewer
@given(content("csv"))
def test_any_recording(folder: Path, data: bytes) -> None:
    (folder / "x.csv").write_bytes(data)
    value_or_one_line(lambda: import_files(folder / "x.csv", folder / "map.toml"))


@few
@given(content("rig"), content("csv"))
def test_any_campaign(folder: Path, rig: bytes, run: bytes) -> None:
    (folder / "camp").mkdir(exist_ok=True)
    (folder / "camp" / "rig.toml").write_bytes(rig)
    (folder / "camp" / "a.csv").write_bytes(run)
    value_or_one_line(lambda: read_campaign(folder / "camp"))


@pytest.mark.parametrize("kind", ["csv", "rig", "model"])
def test_the_good_files_are_read(kind: str, folder: Path) -> None:
    """Lest every reader refuse all that it is given."""
    (folder / "x").write_text(TEXTS[kind])
    read = {"csv": read_run, "rig": read_rig, "model": Model.load}[kind]
    assert value_or_one_line(lambda: read(folder / "x")) is not None
