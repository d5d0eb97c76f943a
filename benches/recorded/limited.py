"""Assessment of a campaign in a separate process with a time limit."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from dataclasses import asdict
from pathlib import Path

from case import Case, Row

PATIENCE = 5.0
OUT_OF_TIME = {-int(s) for s in (getattr(signal, "SIGXCPU", 0), getattr(signal, "SIGKILL", 0)) if s}
ONE = Path(__file__).with_name("one.py")


def scored(case: Case, limit_s: float) -> Row:
    """Diagnose and assess a case in a separate process, and return its row of results.

    The outcome is `failed`, with the reason, if the process fails or takes longer than `limit_s` of
    processor time. If processor time cannot be limited, or the process waits, the limit is
    `PATIENCE` times as long in wall-clock time.
    """
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
            [sys.executable, str(ONE), f"{limit_s:g}"],
            input=json.dumps(asdict(case)),
            capture_output=True,
            text=True,
            timeout=PATIENCE * limit_s,
        )
    except subprocess.TimeoutExpired:
        return row | _failed(f"over {PATIENCE * limit_s:g} s", limit_s)
    if done.returncode in OUT_OF_TIME:
        return row | _failed(f"over {limit_s:g} s of the processor's time", limit_s)
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
        "cpu_s": seconds,
    }
