"""Optional and slow libraries are imported only where they are needed."""

import subprocess
import sys

import jbf
import pytest

EXTENDED = pytest.mark.extended
EFFECTS = "from jbf.cli import main; main(['effects'])"
HEAVY = (
    "scipy", "matplotlib", "jinja2", "rich", "tomlkit", "threadpoolctl", "multiprocessing",
    "concurrent.futures", "asyncio", "starlette", "pandas", "h5py", "pyarrow",
)  # fmt: skip


def imported(code: str) -> set[str]:
    """Modules that are loaded after code has run in a separate process."""
    lines = f"{code}\nimport sys; print('|', *sys.modules)"
    done = subprocess.run([sys.executable, "-c", lines], capture_output=True, text=True, check=True)
    return set(done.stdout.rpartition("|")[2].split())


@pytest.mark.parametrize(
    "code",
    [
        "import jbf",
        "from jbf.cli import main; main(['--help'])",
        pytest.param("from jbf.cli import main; main(['--version'])", marks=EXTENDED),
        pytest.param("from jbf.cli import main; assert main(['diagnoes']) == 2", marks=EXTENDED),
    ],
)
def test_package_and_help_import_neither_numpy_nor_models(code: str) -> None:
    modules = imported(code)
    assert "jbf._core" in modules
    assert not modules & {*HEAVY, "numpy", "jbf.models", "jbf.records"}


DIAGNOSE_HELP = "from jbf.cli import main; main(['diagnose', '--help'])"
MODEL = "import jbf; jbf.Model(jbf.Rig.thesis(), parameters={'f_m': 0.26})"


@pytest.mark.parametrize("code", [EFFECTS, pytest.param(DIAGNOSE_HELP, marks=EXTENDED), MODEL])
def test_effects_command_and_model_construction_do_not_import_scipy(code: str) -> None:
    # Rigs and models are TOML files.
    assert not imported(code) & ({*HEAVY} - {"tomlkit", "concurrent.futures", "multiprocessing"})


def test_plot_package_imports_matplotlib_only_when_drawing_and_never_pyplot() -> None:
    assert "matplotlib" not in imported("import jbf.plot, jbf.reporting.presenters")
    assert "matplotlib.pyplot" not in imported("import jbf.reporting.pictures")


def test_effects_command_does_not_import_modules_of_other_commands() -> None:
    modules = imported(EFFECTS)
    assert "jbf.cli.effects" in modules
    assert not modules & {"jbf.cli.fit", "jbf.cli.diagnose", "jbf.cli.control", "jbf.cli.workbench"}


def test_public_names_are_importable_and_unknown_ones_raise_attribute_error() -> None:
    for name in jbf.__all__:
        assert getattr(jbf, name) is getattr(jbf, name)
    assert dir(jbf) == sorted(jbf.__all__)
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = jbf.no_such_name


def test_diagnosis_modules_import_neither_scipy_stats_nor_scipy_signal() -> None:
    # These two modules would add half a second to every command.
    modules = imported("import jbf.diagnosis.recipe, jbf.diagnosis.check, jbf.cli.diagnose")
    assert "scipy.optimize" in modules
    assert not modules & {"scipy.stats", "scipy.signal"}
