"""Files of known but unsupported formats are refused with a remedy."""

import subprocess
import sys
from pathlib import Path

import pytest
from jbf.errors import InputError
from jbf.importing.formats.registry import FORMATS, UNREAD, format_of


@pytest.mark.parametrize("unread", UNREAD, ids=lambda unread: unread.name)
def test_unsupported_format_is_refused_with_its_name_and_a_remedy(
    unread: object, tmp_path: Path
) -> None:
    known = next(u for u in UNREAD if u is unread)
    paths = [tmp_path / f"a{suffix}" for suffix in known.suffixes]
    for path in paths:
        path.write_bytes(b"\x00\x01\x02\x03")
    for number, magic in enumerate(known.magic):
        paths.append(tmp_path / f"nameless{number}")
        paths[-1].write_bytes(magic + bytes(600))
    for path in paths:
        with pytest.raises(InputError) as refused:
            format_of(path)
        line = str(refused.value)
        assert line.startswith(f"{path}: is {known.name}")
        assert line.endswith(f"which is not supported; {known.remedy}")
        assert "\n" not in line


def test_supported_and_unsupported_formats_have_no_suffix_in_common() -> None:
    read = {suffix for known in FORMATS for suffix in known.suffixes}
    assert not read & {suffix for unread in UNREAD for suffix in unread.suffixes}


def test_look_at_an_unsupported_format_exits_with_2_and_a_one_line_message(tmp_path: Path) -> None:
    path = tmp_path / "axis.svdx"
    path.write_bytes(b"\x00\x01")
    command = [sys.executable, "-m", "jbf", "import", str(path)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 2
    assert (
        "TwinCAT Scope recording (.svdx), which is not supported; export it as CSV" in done.stderr
    )
    assert len(done.stderr.strip().splitlines()) == 1
    assert [p.name for p in tmp_path.iterdir()] == ["axis.svdx"]


def test_text_file_with_the_suffix_of_an_unsupported_format_is_read(tmp_path: Path) -> None:
    path = tmp_path / "curve.raw"
    path.write_text("time [s],force [N],position [mm]\n0.0,1.0,2.0\n0.1,1.1,2.1\n")
    assert format_of(path).name == "text"
