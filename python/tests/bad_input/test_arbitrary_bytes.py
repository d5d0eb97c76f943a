"""Check that a reader of arbitrary bytes returns a value or raises an `InputError` within 20 s."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from input_checks import MAP, MODEL, RIG, csv_text, in_time
from jbf import Import, InputError, Model, Rig, Run, import_files, read_map, read_rig, read_run

TEXTS = {
    "csv": csv_text(),
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
"""Fragments that are inserted into files."""

CHECKS = [HealthCheck.function_scoped_fixture]
FILES = settings(deadline=None, derandomize=True, suppress_health_check=CHECKS)


@st.composite
def broken(draw: st.DrawFn, kind: str) -> bytes:
    """A valid file in which a few ranges are removed, duplicated or overwritten."""
    data = TEXTS[kind].encode()
    for _ in range(draw(st.integers(1, 3))):
        first = draw(st.integers(0, len(data)))
        end = min(len(data), first + draw(st.integers(0, 12)))
        change = draw(st.integers(0, 3))
        if change == 0:
            data = data[:first] + draw(st.sampled_from(PIECES)) + data[end:]
        elif change == 1:
            data = data[:first] + data[end:]
        elif change == 2:
            data = data[:end] + data[first:]
        else:
            data = data[:first] + draw(st.binary(max_size=6)) + data[end:]
    return data


def content(kind: str) -> st.SearchStrategy[bytes]:
    texts = st.text().map(lambda text: text.encode("utf-8", errors="surrogatepass"))
    return st.one_of(broken(kind), broken(kind), st.binary(max_size=200), texts)


def value_or_one_line(read: Callable[[], object]) -> object:
    """Return the value that is read, or None if the reader raises a one-line `InputError`."""
    try:
        with in_time():
            return read()
    except InputError as error:
        message = str(error)
    assert message
    assert not re.search(r"[\x00-\x1f\x7f-\x9f]", message)
    return None


def check_run(folder: Path, data: bytes) -> None:
    (folder / "x.csv").write_bytes(data)
    run = value_or_one_line(lambda: read_run(folder / "x.csv"))
    if isinstance(run, Run):
        assert len(run) >= 10
        assert all(np.isfinite(values).all() for values in run.columns().values())
        assert (np.diff(run.time_s) > 0.0).all()


def check_rig(folder: Path, data: bytes) -> None:
    (folder / "x.toml").write_bytes(data)
    rig = value_or_one_line(lambda: read_rig(folder / "x.toml"))
    if isinstance(rig, Rig):
        rig.write(folder / "y.toml")
        assert read_rig(folder / "y.toml") == rig


def check_model(folder: Path, data: bytes) -> None:
    (folder / "x.toml").write_bytes(data)
    model = value_or_one_line(lambda: Model.load(folder / "x.toml"))
    if isinstance(model, Model) and model.law == "coulomb":
        assert np.isfinite(model.predict(read_run(folder / "a.csv"))).all()


def check_map(folder: Path, data: bytes) -> None:
    (folder / "x.toml").write_bytes(data)
    if value_or_one_line(lambda: read_map(folder / "x.toml")) is not None:
        imported = value_or_one_line(lambda: import_files(folder / "a.csv", folder / "x.toml"))
        if isinstance(imported, Import):
            assert all(np.isfinite(run.friction).all() for run in imported.runs)


def check_recording(folder: Path, data: bytes) -> None:
    (folder / "x.csv").write_bytes(data)
    value_or_one_line(lambda: import_files(folder / "x.csv", folder / "map.toml"))


Check = Callable[[Path, bytes], None]
READERS = [("csv", check_run), ("rig", check_rig), ("model", check_model), ("map", check_map),
           ("csv", check_recording)]  # fmt: skip


@pytest.mark.parametrize("examples", [15, pytest.param(150, marks=pytest.mark.extended)])
@pytest.mark.parametrize(("kind", "check"), READERS)
def test_randomly_changed_file_is_read_or_refused(
    kind: str, check: Check, examples: int, folder: Path
) -> None:
    @settings(parent=FILES, max_examples=examples)
    @given(content(kind))
    def check_examples(data: bytes) -> None:
        check(folder, data)

    check_examples()


@pytest.mark.parametrize("kind", ["csv", "rig", "model"])
def test_valid_csv_rig_and_model_file_is_read_without_an_error(kind: str, folder: Path) -> None:
    """Guard against a reader that refuses every file, which would also pass the test above."""
    (folder / "x").write_text(TEXTS[kind])
    read = {"csv": read_run, "rig": read_rig, "model": Model.load}[kind]
    assert value_or_one_line(lambda: read(folder / "x")) is not None
