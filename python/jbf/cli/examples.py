"""Examples at the end of each command's help."""

from __future__ import annotations

import argparse

EXAMPLES: dict[str, tuple[str, ...]] = {
    "demo": ("jbf demo", "jbf demo /tmp/demo"),
    "workbench": ("jbf workbench", "jbf workbench measurements --no-browser --port 8000"),
    "import": (
        "jbf import log.tdms",
        "jbf import log.tdms --map map.toml --folder campaign",
        "jbf import logs/*.csv --map map.toml --folder campaign --plot cut.png",
    ),
    "compare": ("jbf compare model.toml runs/ --report compare.html",),
    "fit": (
        "jbf fit rig.toml runs/",
        "jbf fit rig.toml runs/ --law lugre --effects inertia,sensor_offset --out model.toml",
        "jbf fit rig.toml runs/ --fix f_m=0.26 --bootstrap 50 --out model.toml",
    ),
    "diagnose": (
        "jbf diagnose rig.toml runs/ --out model.toml --report report.html",
        "jbf diagnose campaign --law auto --hold-out 'check_*' --json found.json",
        "jbf diagnose --many rigs --jobs 2 --report reports",
    ),
    "power": (
        "jbf power rig.toml planned/ --noise 0.5",
        "jbf power model.toml planned/ --json power.json",
    ),
    "check": ("jbf check model.toml runs/ -n 200 --resume answers.jsonl",),
    "plan": ("jbf plan rig.toml --minutes 10 --max-velocity 0.1 --noise 0.5 --folder planned",),
    "predict": (
        "jbf predict model.toml motion.csv --out friction.csv",
        "jbf predict model.toml motion.csv",
    ),
    "export": (
        "jbf export model.toml --rust friction.rs",
        "jbf export model.toml --c friction.h",
        "jbf export model.toml runs/ --to table --out friction.csv",
        "jbf export model.toml runs/ --to table --points 12 --max-loss 0.05 --json loss.json",
        "jbf export model.toml runs/ --to c --joint elbow --out elbow.c",
        "jbf export model.toml runs/ --to fmu2 --joint elbow --out elbow.fmu",
        "jbf export model.toml runs/ --to mjcf --joint elbow --out elbow.xml",
    ),
    "effects": ("jbf effects", "jbf effects presliding", "jbf effects --law lugre"),
    "control": ("jbf control tables", "jbf control run --scheme none,observed --plot loops.png"),
    "control run": (
        "jbf control run model.toml --scheme none,observed --plot loops.png",
        "jbf control run --scheme observed --task 'velocity sine' --csv loop.csv",
    ),
    "control tables": ("jbf control tables --plot tables.png",),
    "control tune": ("jbf control tune model.toml --toml settings.toml",),
    "control robustness": ("jbf control robustness model.toml --json robustness.json",),
}
"""Example command lines by command, for the end of its help."""
HEAD = "examples:"


class Help(argparse.HelpFormatter):
    """Help formatter that keeps each example on its own line."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        if text.startswith(HEAD):
            return "\n".join(indent + line for line in text.splitlines())
        return super()._fill_text(text, width, indent)


def examples(prog: str) -> str | None:
    """Text of the examples for the end of a command's help; None without examples."""
    lines = EXAMPLES.get(prog.removeprefix("jbf "))
    return None if lines is None else "\n".join([HEAD, *(f"  {line}" for line in lines)])
