"""README and documentation: examples run, commands are valid, links and names exist."""

import re
import shlex
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import jbf
import pytest
from input_checks import Capture
from jbf import Model, Rig
from jbf.cli import main
from jbf.importing.cutting.settings import METHODS, CutSettings
from jbf.importing.expression import FUNCTIONS
from jbf.importing.formats.registry import FORMATS
from jbf.importing.formats.table import Options
from jbf.models.catalogue import laws

ROOT = Path(__file__).resolve().parents[3]
DOCS = ("control", "dependencies", "drives", "import", "versions")
PAGES = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "release/README.md")
PAGES += tuple(f"docs/{name}.md" for name in DOCS)


def text_of(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def python_of(name: str) -> str:
    (code,) = re.findall(r"```python\n(.*?)```", text_of(name), flags=re.DOTALL)
    return str(code)


def targets() -> set[str]:
    return set(re.findall(r"^([a-z][a-z-]*):", text_of("Makefile"), flags=re.MULTILINE))


@pytest.mark.parametrize("page", PAGES)
def test_relative_links_of_a_page_lead_to_existing_files(page: str) -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", text_of(page))
    missing = [link for link in links if not (ROOT / page).parent.joinpath(link).exists()]
    assert missing == []


@pytest.mark.parametrize("page", PAGES)
def test_make_targets_named_on_a_page_exist_in_the_makefile(page: str) -> None:
    named = set(re.findall(r"(?:`|^)make ([a-z-]+)", text_of(page), flags=re.MULTILINE))
    assert named <= targets()


def test_make_help_lists_every_target() -> None:
    listed = set(re.findall(r'@echo "make ([a-z-]+)', text_of("Makefile")))
    assert listed | {"help", "bits-table"} == targets()


def test_cargo_and_citation_files_have_the_version_of_the_package() -> None:
    version = jbf.__version__
    assert f'\nversion = "{version}"\n' in text_of("Cargo.toml")
    assert f"\nversion: {version}\n" in text_of("CITATION.cff")


def test_example_of_the_control_page_prints_an_error_ratio_below_one_tenth(capsys: Capture) -> None:
    exec(compile(python_of("docs/control.md"), "docs/control.md", "exec"), {})
    assert 0.0 < float(capsys.readouterr().out) < 0.1


def control_commands() -> list[str]:
    """The commands of docs/control.md with a short run time."""
    text = text_of("docs/control.md").replace("\n--counts", " --counts")
    commands = re.findall(r"^jbf (control (?:run|tune)[^#\n]*)", text, re.MULTILINE)
    return commands + re.findall(r"`jbf (control run model.toml --damping[^`]*)`", text)


@pytest.mark.extended
@pytest.mark.usefixtures("working_folder")
@pytest.mark.parametrize("command", control_commands())
def test_command_of_the_control_page_prints_no_error(command: str, capsys: Capture) -> None:
    for name in ("model.toml", "bare.toml"):
        Model(Rig.thesis("4.2")).save(name)
    rows = [f"{0.02 * i:.2f},{0.02 * (-1) ** (i // 40):.2f}" for i in range(300)]
    Path("run.csv").write_text("\n".join(["time_s,velocity_m_s", *rows]) + "\n")
    assert main(shlex.split(command)) == 0
    assert capsys.readouterr().err == ""


def test_import_page_names_every_option_function_and_format() -> None:
    text = text_of("docs/import.md")
    options = [f.name for f in (*fields(Options), *fields(CutSettings))]
    assert [name for name in options if f"`{name}`" not in text] == []
    words = [*METHODS, *FUNCTIONS]
    assert [w for w in words if f'"{w}"' not in text and f"`{w}`" not in text] == []
    extras = [known.extra for known in FORMATS if known.extra]
    assert [extra for extra in extras if f"`jbf[{extra}]`" not in text] == []
    project = text_of("pyproject.toml")
    assert [e for e in extras if not re.search(rf"^{e} = \[", project, re.MULTILINE)] == []


def test_every_law_has_a_section_to_which_the_workbench_links() -> None:
    headings = re.findall(r"^## (\w+)$", (ROOT / "docs/laws.md").read_text("utf-8"), re.M)
    assert {law.name for law in laws().values()} <= set(headings)


def test_tables_of_the_validation_page_are_those_of_the_result_files() -> None:
    command = [sys.executable, str(ROOT / "benches" / "promises.py"), "--check"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"run benches/promises.py\n{done.stderr}"
