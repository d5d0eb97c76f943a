"""Run the code of a page from top to bottom in an empty folder, and compare the shown output.

`.venv/bin/python docs/site/snippets.py PAGE...`

- a block with `title="NAME"` is a file of that name;
- `python` runs in one interpreter per page, `sh` in bash, in the folder where the last block ended;
- `output` is the output of the block before it: each line, in that order, except for blanks; `...`
  omits any lines, and within a line any words;
- `text` and blocks without a language are prose;
- `jbf` and `import jbf` are the source of this repository, whichever copy is installed;
- a first line `# in a clone of the repository` runs a block at its root;
- a block below `<!-- not tested: WHY -->` is not run; readers of the page do not see the comment;
- `<!-- needs: TOOL... -->` names programs and targets of Rust without which a page is skipped;
- `<!-- given: NAME -->` in a page copies the files that the text presumes into the folder
  (`GIVEN`); further words are its arguments.

A page that has other code (`rust`, `c`, ...) without a title is at fault, unless `ELSEWHERE` names
the test that compiles it.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable
from pathlib import Path

from pages import DOCS, ROOT, Block, blocks, name_of

ELSEWHERE = {
    ("crates/jbf-core/README.md", "rust"): "cargo test --doc -p jbf-core",
    ("docs/control.md", "python"): "python/tests/project/test_documentation.py",
}
PROSE = {"", "text"}
SIMULATOR, SOURCE = ROOT / "simulator", ROOT / "python"
DEMO = SOURCE / "jbf" / "data" / "demo" / "hidden"
WHY = re.compile(r"not tested: \S+ \S+ \S+")
SECONDS = 1800
"""Time after which a shell block is considered to hang, s."""


class Wrong(Exception):
    """Error for a page whose code does not have the shown result."""


def _campaign(folder: Path) -> None:
    """Copy the shipped campaign to a folder: a rig, its runs, further and planned runs, models."""
    import jbf

    shutil.copy(DEMO / "rig.toml", folder / "rig.toml")
    for name in ("runs", "other_runs", "planned_runs"):
        (folder / name).mkdir()
    for path in DEMO.glob("*.csv"):
        shutil.copy(path, folder / "runs" / path.name)
    shutil.copy(DEMO / "unseen" / "triangle_0.5.csv", folder / "other_runs")
    shutil.copy(DEMO / "two_way_0.25.csv", folder / "run.csv")
    motion = jbf.read_run(folder / "run.csv")
    bare = jbf.Run.from_arrays(motion.time_s, motion.velocity, angle_rad=motion.angle_rad)
    for name in ("motion.csv", "planned_runs/slow.csv"):
        bare.write_csv(folder / name)
    rig = jbf.Rig.thesis("4.2")
    for name in ("model.toml", "bare.toml"):
        jbf.Model(rig).save(folder / name)


def _warm_campaign(folder: Path) -> None:
    """Copy the shipped campaign with rising temperature and a seal whose friction depends on it."""
    import jbf
    import numpy as np

    _campaign(folder)
    for number, path in enumerate(sorted((folder / "runs").glob("*.csv"))):
        run = jbf.read_run(path)
        warmth_c = 42.0 + 2.0 * np.sin(0.7 * run.time_s + number) + 0.05 * run.time_s
        grip_n = 0.35 * (warmth_c - 40.0) * np.tanh(run.velocity / 0.01)
        jbf.Run.from_arrays(
            run.time_s,
            run.velocity,
            run.friction + grip_n,
            angle_rad=run.angle_rad,
            load_n=run.load_n,
            temperature_c=warmth_c,
            name=run.name,
        ).write_csv(path)


def _joint(folder: Path) -> None:
    """Write the recording of a simulated joint with noise to a folder: a rig and its runs."""
    import jbf
    import numpy as np

    drive = jbf.Drive("rotary", "percent", rated_torque_n_m=2.0, gear_ratio=5.0)
    rig = jbf.Rig(drive=drive)
    values = {"F_c": 1.2, "F_s": 1.7, "v_s": 0.12, "F_v": 0.4, "inertia.m_e": 0.05}
    values |= {"cogging.A": 0.15, "cogging.pitch": 2.0 * np.pi / 14.0, "cogging.phase_rad": 0.6}
    model = jbf.Model(rig, "stribeck", ["inertia", "cogging"], values)
    rig.write(folder / "rig.toml")
    (folder / "runs").mkdir()
    noise = np.random.default_rng(1)
    for number, (omega, top) in enumerate([(0.7, 1.5), (1.9, 0.6), (0.4, 0.3)]):
        time_s = np.arange(0.0, 12.0, 0.005)
        velocity = top * np.sin(omega * time_s) * (1.0 + 0.2 * np.sin(0.31 * time_s))
        steps = 0.0025 * (velocity[1:] + velocity[:-1])
        angle = np.concatenate([[0.0], np.cumsum(steps)])
        run = jbf.Run.from_arrays(time_s, velocity, angle_rad=angle)
        torque = model.predict(run) + 0.02 * noise.standard_normal(len(run))
        columns = (time_s, angle, velocity, torque / drive.unit_n)
        lines = [
            ",".join(map(repr, row)) for row in zip(*(c.tolist() for c in columns), strict=True)
        ]
        head = "time_s,angle_rad,velocity_rad_s,torque_percent"
        path = folder / "runs" / f"sine_{number}.csv"
        path.write_text("\n".join([head, *lines, ""]))


def _schema(folder: Path) -> None:
    """Copy the published JSON schema to a folder."""
    shutil.copy(ROOT / "docs" / "schema" / "results.json", folder)


def _effect(folder: Path, name: str) -> None:
    """Write runs with the effect `name` to a folder."""
    sys.path.insert(0, str(DOCS))
    import effects

    effects.record(effects.catalogue()[name], folder)


GIVEN: dict[str, Callable[..., None]] = {
    "campaign": _campaign,
    "warm_campaign": _warm_campaign,
    "joint": _joint,
    "schema": _schema,
    "effect": _effect,
}
IN_A_CLONE = "# in a clone of the repository"


def squeezed(text: str) -> str:
    """Collapse the whitespace in a text to single blanks."""
    return " ".join(text.split())


def compare(shown: str, output: str) -> None:
    """Raise `Wrong` unless the shown lines occur in the output in this order."""
    lines, at = [squeezed(line) for line in output.splitlines()], 0
    for wanted in (squeezed(line) for line in shown.splitlines()):
        if wanted in ("", "..."):
            continue
        pattern = re.compile(".*?".join(re.escape(part) for part in wanted.split("...")))
        while at < len(lines) and not pattern.fullmatch(lines[at]):
            at += 1
        if at == len(lines):
            raise Wrong(f"is not printed here: {wanted}\nbut:\n{output[-6000:]}")
        at += 1


def not_tested(note: str) -> bool:
    """Return True if the comment of a block marks it as not tested and gives a reason.

    The reason must have three words or more.
    """
    if not note.startswith("not tested"):
        return False
    if not WHY.match(note):
        raise Wrong(f"gives no reason: {note}")
    return True


def missing(page: Path) -> list[str]:
    """Return the programs and Rust targets that a page needs and this machine lacks."""
    requirements = re.findall(r"<!-- needs: (.*?) -->", page.read_text(encoding="utf-8"))
    return [name for name in " ".join(requirements).split() if not _is_there(name)]


def _is_there(name: str) -> bool:
    if name.count("-") < 2 or not name.startswith("thumb"):
        return shutil.which(name) is not None
    added = ["rustup", "target", "add", name]
    return (
        shutil.which("rustup") is not None
        and not subprocess.run(added, capture_output=True).returncode
    )


class Reader:
    """Reader that runs the code blocks of a page in their order."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.names: dict[str, object] = {"__name__": "page"}
        self.said: str | None = None

    def follow(self, block: Block) -> None:
        """Run a code block, and compare its output if the page shows it."""
        if not_tested(block.note):
            self.said = None
        elif block.title:
            path = self.folder / block.title
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.body, encoding="utf-8")
        elif block.language == "python":
            self.said = self.python(block)
        elif block.language == "sh":
            self.said = self.shell(block.body)
        elif block.language == "output":
            if self.said is None:
                raise Wrong("shows what a block prints, and none before it was run")
            compare(block.body, self.said)
        elif block.language not in PROSE:
            raise Wrong(f"`{block.language}` is neither run nor a file (title=)")

    def python(self, block: Block) -> str:
        """Run a Python block and return its output."""
        printed = io.StringIO()
        # Line numbers of a traceback are those of the page.
        code = compile("\n" * block.row + block.body, "the page", "exec")
        here = os.getcwd()
        os.chdir(self.folder)
        try:
            with contextlib.redirect_stdout(printed):
                exec(code, self.names)
        finally:
            os.chdir(here)
        return printed.getvalue()

    def shell(self, body: str) -> str:
        """Run a shell block and return its output; the next block starts in its last folder."""
        place = self.folder / ".folder"
        script = f'{body}\npwd > "{place}"'
        bin_ = Path(sys.executable).parent
        environment = {
            **os.environ,
            "PATH": f"{Path(__file__).parent / 'bin'}:{bin_}:{os.environ['PATH']}",
            "PYTHONPATH": f"{SOURCE}:{SIMULATOR}",
            "JBF": str(ROOT),
            "JBF_PYTHON": sys.executable,
        }
        where = Path(place.read_text().strip()) if place.exists() else self.folder
        if body.startswith(IN_A_CLONE):
            where, script = ROOT, body
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", script],
            cwd=where,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            text=True,
            timeout=SECONDS,
        )
        if done.returncode != 0:
            raise Wrong(f"ended with {done.returncode}:\n{done.stdout}")
        return done.stdout


def run(page: Path, keep: Path | None = None) -> None:
    """Run all code blocks of a page; raise `Wrong` with the line of the page."""
    text = page.read_text(encoding="utf-8")
    name = name_of(page)
    with tempfile.TemporaryDirectory() as temporary:
        folder = (keep or Path(temporary)).resolve()
        for given, *of in map(str.split, re.findall(r"<!-- given: (.*?) -->", text)):
            GIVEN[given](folder, *of)
        reader = Reader(folder)
        for block in blocks(text):
            if (name, block.language) in ELSEWHERE:
                continue
            try:
                reader.follow(block)
            except Wrong as wrong:
                raise Wrong(f"{name}:{block.row}: {wrong}") from None
            except Exception:
                raise Wrong(f"{name}:{block.row}: {traceback.format_exc()}") from None


if __name__ == "__main__":
    sys.path[:0] = [str(SOURCE), str(SIMULATOR)]
    for named in sys.argv[1:]:
        try:
            run(Path(named).resolve())
        except Wrong as fault:
            sys.exit(str(fault))
