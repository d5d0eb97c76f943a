"""Cost of the loop on a Cortex-M4F: builds the programs, runs them in QEMU, prints tables.

`make firmware`, or `python examples/firmware/report.py`. Fails where a step costs more than its
budget, where a bit differs from a laptop's, where the loop could panic, where it is too large, or
where the RTIC application does not compile.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NoReturn

from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection

HERE = Path(__file__).resolve().parent
TRIPLE = "thumbv7em-none-eabihf"
OUT = Path(os.environ.get("CARGO_TARGET_DIR", HERE / "target")).resolve() / TRIPLE / "release"
QEMU = ["qemu-system-arm", "-M", "mps2-an386", "-cpu", "cortex-m4", "-icount", "shift=6"]
CYCLES = 336_000
"""Of 2 ms at 168 MHz."""
RAM_END = 0x2040_0000
FLASH_LIMIT, RAM_LIMIT = 16 * 1024, 1024

# Most instructions that the worst step may take.
BUDGET = {
    "observer/velocity": 40,
    "observer/coulomb/p=1": 120,
    "model/reduced/euler/f32": 400,
    "loop/learning": 600,
    "loop/learning/position": 600,
    "loop/observed/journal": 1200,
    "loop/observed/journal/position": 1200,
    "model/full/rodas3/f32": 100_000,
    "model/full/rodas5p/f32": 100_000,
}
PRECISION = 1e-3
LOOPS = ["none", "coulomb", "table", "repetitive", "learning", "observed", "observed_full"]


def stop(reason: str) -> NoReturn:
    print(f"firmware: {reason}", file=sys.stderr)
    raise SystemExit(2)


def quiet(*command: str) -> str | None:
    """Output of a command; None if it fails or is missing."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=HERE)
    except (OSError, subprocess.CalledProcessError):
        return None
    return done.stdout


def has_target() -> bool:
    folder = quiet("rustc", "--print", "target-libdir", "--target", TRIPLE)
    return folder is not None and Path(folder.strip()).is_dir()


def toolchain() -> tuple[list[str], dict[str, str]]:
    """Cargo and its environment: the user's toolchain, or Debian's, which builds `core` too."""
    if shutil.which("qemu-system-arm") is None:
        stop("QEMU is missing: apt-get install qemu-system-arm")
    debian = quiet("dpkg", "-L", "rustc-web")
    wanted = os.environ.get("JBF_DEBIAN_RUST") == "1"
    if not wanted and (has_target() or (quiet("rustup", "target", "add", TRIPLE) and has_target())):
        return ["cargo"], dict(os.environ)
    if debian is None:
        stop(
            f"the target is missing: rustup target add {TRIPLE}, or without rustup "
            "apt-get install rustc-web cargo-web rust-web-src lld"
        )
    folder = next(Path(f).parent for f in (debian or "").splitlines() if f.endswith("bin/rustc"))
    name = f"CARGO_TARGET_{TRIPLE.upper().replace('-', '_')}"
    extra = {
        "RUSTC": str(folder / "rustc"),
        "RUSTC_BOOTSTRAP": "1",
        f"{name}_LINKER": "ld.lld",
        "CARGO_UNSTABLE_BUILD_STD": "core",
    }
    return [str(folder / "cargo")], {**os.environ, **extra}


def build(program: str, feature: str, tools: tuple[list[str], dict[str, str]]) -> Path:
    cargo, environment = tools
    options = ["--release", "--quiet", "--no-default-features", "--features", feature]
    subprocess.run(
        [*cargo, "build", "--bin", program, *options], check=True, cwd=HERE, env=environment
    )
    return OUT / program


def run(program: Path) -> str:
    """The output of a program under QEMU."""
    command = [*QEMU, "-semihosting", "-nographic", "-kernel", str(program)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=900)
    except subprocess.TimeoutExpired:
        stop(f"{program.name} did not end within 900 s")
    print(done.stderr, file=sys.stderr, end="")
    if done.returncode != 0:
        stop(f"{program.name} failed:\n{done.stdout}")
    return done.stdout


def costs(report: str) -> list[str]:
    """Print the table of steps; the names of those beyond their budget."""
    print("| step of | instructions, median | worst | worst of 2 ms | budget | RAM, B | stack, B |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    over, heading = [], ""
    for line in report.splitlines():
        word, *rest = line.split()
        if word in ("law", "loop"):
            heading = f"{word}/{rest[0]}"
        elif word == "row":
            name = heading if rest[0] in ("law", "loop") else rest[0]
            median, worst, ram, stack = map(int, rest[1:])
            limit = BUDGET.get(name)
            shown = "" if limit is None else f"{limit:,}"
            if limit is not None and worst > limit:
                over.append(f"{name}: {worst} instructions, budget {limit}")
            share = 100.0 * worst / CYCLES
            print(
                f"| `{name}` | {median:,} | {worst:,} | {share:.2f} % | {shown} | {ram} | {stack} |"
            )
        elif word == "precision":
            share = float(rest[0])
            print(
                f"\nFull model, f32 against f64, 2 rad/s, 2 ms: {share:.1e} of the loop's peak "
                f"(at most {PRECISION:g})\n"
            )
            if not share <= PRECISION:
                over.append(f"the full model in f32 is off by {share:.1e} of the loop's peak")
    return over


def panics(elf: ELFFile) -> list[str]:
    """Symbols of a program that belong to panics or to an allocator."""
    table = elf.get_section_by_name(".symtab")
    if not isinstance(table, SymbolTableSection):
        stop("the program has no symbols to read")
    signs = ("panic", "unwrap_failed", "expect_failed", "slice_index", "alloc5alloc")
    ours = ("rust_begin_unwind", "panic_handler")
    names = [symbol.name for symbol in table.iter_symbols()]
    return [n for n in names if any(s in n for s in signs) and not any(o in n for o in ours)]


def stack_of(program: Path) -> int:
    """Bytes of stack that a program has touched after some seconds of its loop, all frames."""
    with tempfile.TemporaryDirectory() as folder:
        seen = Path(folder) / "ram"
        size = 8192
        command = [*QEMU, "-display", "none", "-serial", "none", "-monitor", "stdio", "-kernel"]
        qemu = subprocess.Popen(
            [*command, str(program)], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
        )
        time.sleep(1.5)
        qemu.communicate(f'pmemsave {RAM_END - size} {size} "{seen}"\nquit\n', timeout=60)
        memory = seen.read_bytes()
    # RAM begins as zeros.
    return size - next((i for i, byte in enumerate(memory) if byte), size)


def every_step(tools: tuple[list[str], dict[str, str]]) -> list[str]:
    """Print whether any step of anything could panic; what is wrong."""
    with build("steps", "observed", tools).open("rb") as file:
        found = panics(ELFFile(file))
    print(f"every law, stepper, effect and loop, f32 and f64: {len(found)} symbols of panics")
    return [f"a step could panic: {', '.join(found)}"] if found else []


def c_library(tools: tuple[list[str], dict[str, str]]) -> list[str]:
    """Print whether anything that C may call could panic; what is wrong."""
    cargo, environment = tools
    crate = HERE.parents[1] / "crates" / "jbf-c"
    # Its own folder: the flags of this one's configuration are for programs.
    target = OUT.parents[1] / "c"
    options = ["--release", "--quiet", "--no-default-features", "--target", TRIPLE]
    options += ["--crate-type", "staticlib", "--target-dir", str(target)]
    subprocess.run([*cargo, "rustc", *options], check=True, cwd=crate, env=environment)
    header = (crate / "include" / "jbf.h").read_text(encoding="utf-8")
    declared = re.findall(r"^JBF_DECLARE\((\w+), (\w+),", header, re.MULTILINE)
    names = ("init", "effect", "start", "step", "predict")
    wanted = [f"jbf_{law}_{kind}_{name}" for law, kind in declared for name in names]
    library, linked = target / TRIPLE / "release" / "libjbf_c.a", target / "all.elf"
    linker = shutil.which("ld.lld") or next(
        Path((quiet("rustc", "--print", "sysroot") or "").strip()).rglob("rust-lld"), None
    )
    if linker is None:
        return ["no linker for the C library: apt-get install lld"]
    flavor = [] if str(linker).endswith("ld.lld") else ["-flavor", "gnu"]
    undefined = [f"--undefined={name}" for name in wanted]
    command = [str(linker), *flavor, "-m", "armelf", "--gc-sections", "--entry", wanted[0]]
    subprocess.run([*command, *undefined, str(library), "-o", str(linked)], check=True)
    with linked.open("rb") as file:
        found = panics(ELFFile(file))
    print(f"libjbf_c.a, all {len(wanted)} functions: {len(found)} symbols of panics")
    return [f"the C library could panic: {', '.join(found)}"] if found else []


def rtic_application(tools: tuple[list[str], dict[str, str]]) -> None:
    """Build the application in examples/rtic, which needs a board to run."""
    cargo, environment = tools
    subprocess.run(
        [*cargo, "build", "--release", "--quiet"],
        check=True,
        cwd=HERE.parent / "rtic",
        env=environment,
    )
    print("examples/rtic: compiled")


def flight(tools: tuple[list[str], dict[str, str]]) -> list[str]:
    """Print the table of the programs that would be flashed; what is wrong with them."""
    print("| `control` with | flash, B | static RAM, B | stack, B | symbols of panics |")
    print("| --- | --- | --- | --- | --- |")
    wrong = []
    for name in LOOPS:
        program = build("control", name, tools)
        with program.open("rb") as file:
            elf = ELFFile(file)
            sizes = {s.name: s["sh_size"] for s in elf.iter_sections()}
            found = panics(elf)
        flash = sum(sizes.get(s, 0) for s in (".vector_table", ".text", ".rodata", ".data"))
        static, stack = sizes.get(".data", 0) + sizes.get(".bss", 0), stack_of(program)
        print(f"| `{name}` | {flash:,} | {static} | {stack:,} | {len(found)} |")
        if found:
            wrong.append(f"control with {name} could panic: {', '.join(found)}")
        if flash > FLASH_LIMIT:
            wrong.append(f"control with {name}: {flash} B of flash, at most {FLASH_LIMIT}")
        if static + stack > RAM_LIMIT:
            wrong.append(f"control with {name}: {static + stack} B of RAM, at most {RAM_LIMIT}")
    return wrong


def main() -> None:
    tools = toolchain()
    print("Cortex-M4F in QEMU: instructions, which are not cycles; 2 ms are 336,000 cycles.\n")
    wrong = costs(run(build("budget", "observed", tools)))
    wrong += flight(tools)
    print()
    wrong += every_step(tools)
    wrong += c_library(tools)
    rtic_application(tools)
    print(run(build("bits", "observed", tools)).strip())
    if wrong:
        print("\n".join(wrong), file=sys.stderr)
        raise SystemExit(1)


if __name__ == "__main__":
    main()
