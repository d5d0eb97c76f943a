"""A campaign in a process of its own, ended where it takes too long."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from dataclasses import asdict
from pathlib import Path

from case import Case, Row

ONE = Path(__file__).with_name("one.py")


def scored(case: Case, limit_s: float) -> Row:
    """The row of a case; judged `failed`, and why, where it took over `limit_s` or broke."""
    row: Row = {
        "key": case.key,
        "kind": case.kind,
        "effects": list(case.effects),
        "artefacts": list(case.artefacts),
        "strength": case.strength,
        "effect_over_noise": case.effect_over_noise,
    }
    begun = time.monotonic()
    try:
        done = subprocess.run(
            [sys.executable, str(ONE)],
            input=json.dumps(asdict(case)),
            capture_output=True,
            text=True,
            timeout=limit_s,
        )
    except subprocess.TimeoutExpired:
        return row | _failed(f"over {limit_s:g} s", limit_s)
    if done.returncode:
        last = [line for line in done.stderr.splitlines() if line.strip()] or ["no word"]
        return row | _failed(last[-1], time.monotonic() - begun)
    answer: Row = json.loads(done.stdout)
    return row | answer


def _failed(why: str, seconds: float) -> Row:
    return {
        "judged": "failed",
        "why": why,
        "verdict": "-",
        "named": [],
        "names_all": False,
        "findings": [],
        "found": [],
        "not_found": [],
        "untrue_findings": [],
        "seconds": seconds,
    }
