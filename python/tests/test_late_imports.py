"""What nobody asked for is not imported: a command line answers at once, a prediction soon."""

from __future__ import annotations

import subprocess
import sys

import jbf
import pytest

HEAVY = (
    "scipy", "matplotlib", "jinja2", "rich", "tomlkit", "threadpoolctl", "multiprocessing",
    "concurrent.futures", "asyncio", "starlette", "pandas", "h5py", "pyarrow",
)  # fmt: skip


def imported(code: str) -> set[str]:
    """The modules that are there after some lines, in a process of their own."""
    lines = f"{code}\nimport sys; print('|', *sys.modules)"
    done = subprocess.run([sys.executable, "-c", lines], capture_output=True, text=True, check=True)
    return set(done.stdout.rpartition("|")[2].split())


@pytest.mark.parametrize(
    "code",
    [
        "import jbf",
        "from jbf.cli import main; main(['--help'])",
        "from jbf.cli import main; main(['--version'])",
        "from jbf.cli import main; assert main(['diagnoes']) == 2",
    ],
)
def test_the_package_and_its_help_import_nothing_heavy(code: str) -> None:
    there = imported(code)
    assert "jbf._core" in there
    assert not there & {*HEAVY, "numpy", "jbf.models", "jbf.records"}


@pytest.mark.parametrize(
    "code",
    [
        "from jbf.cli import main; main(['effects'])",
        "from jbf.cli import main; main(['diagnose', '--help'])",
        "import jbf; jbf.Model(jbf.Rig.thesis(), parameters={'f_m': 0.26})",
    ],
)
def test_what_needs_no_fit_waits_for_no_scipy(code: str) -> None:
    # Rigs and models are TOML.
    assert not imported(code) & ({*HEAVY} - {"tomlkit", "concurrent.futures", "multiprocessing"})


def test_a_command_loads_no_other() -> None:
    there = imported("from jbf.cli import main; main(['effects'])")
    assert "jbf.cli.effects" in there
    assert not there & {"jbf.cli.fit", "jbf.cli.diagnose", "jbf.cli.control", "jbf.cli.workbench"}


def test_every_public_name_comes_when_it_is_asked_for() -> None:
    for name in jbf.__all__:
        assert getattr(jbf, name) is getattr(jbf, name)
    assert set(jbf.__all__) <= set(dir(jbf))
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = jbf.no_such_name


def test_words_are_said_without_what_draws() -> None:
    """The door knows pictures by name alone, until one is asked for."""
    assert "matplotlib.axes" not in imported("import jbf.reporting.door")


def test_a_diagnosis_imports_no_statistics_and_no_signal_processing() -> None:
    # Half a second of every command, for what scipy.special and a filter of the core say as well.
    there = imported("import jbf.diagnosis.recipe, jbf.diagnosis.check, jbf.cli.diagnose")
    assert "scipy.optimize" in there
    assert not there & {"scipy.stats", "scipy.signal"}
