"""Time and memory of a diagnosis of a long recording: `python benches/long_recording.py`.

The recording is that of a simulated slide (`rigsim.axes`, which shares no code with the library) at
50 Hz, with one hidden effect or none, divided into runs of about five minutes. The program prints
the verdict, the named effects, the wall-clock and processor time, the largest memory of the
process, and the ratio of held-out RMS to noise.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from pathlib import Path

import jbf

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "simulator"))

from drives import recorded
from rigsim import AXIS_EFFECTS, axis_campaign

STEP_S, RUN_S = 0.02, 320.0
HOUR_S = 3600.0
GIB_IN_KIB = 1024.0**2


def main() -> int:
    """Simulate and diagnose a recording; fail if the names differ from the hidden effects."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("--hours", type=float, default=24.0)
    parser.add_argument("--effect", default="inertia", help="what is hidden, or none")
    parser.add_argument("--law", default="coulomb")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    hidden = () if given.effect == "none" else (given.effect,)
    if not set(hidden) <= set(AXIS_EFFECTS):
        parser.error(f"--effect {given.effect}: choose from none, {', '.join(AXIS_EFFECTS)}")
    count = max(round(given.hours * HOUR_S / RUN_S), 1)
    records, truth = axis_campaign(given.seed, hidden, runs=count + 1, run_s=RUN_S, step_s=STEP_S)
    *runs, other = [recorded(record, joint=False) for record in records]
    del records
    samples = sum(len(run) for run in runs)
    print(f"{given.hours:g} h, {count} runs, {samples} samples; {_peak_gib():.2f} GiB", flush=True)

    last = ""

    def report(message: str, done: int, total: int) -> None:
        nonlocal last
        if message != last:
            print(
                f"{time.monotonic() - begun:7.0f} s  {_peak_gib():5.2f} GiB  {message}", flush=True
            )
            last = message

    begun, worked = time.monotonic(), time.process_time()
    diagnosis = jbf.diagnose(jbf.Rig(), runs, law=given.law, progress=report)
    wall, cpu = time.monotonic() - begun, time.process_time() - worked
    held_out = jbf.compare(diagnosis.model, [other]).rms / float(str(truth["noise_n"]))
    named = (*diagnosis.machine, *diagnosis.effects)
    print(f"{diagnosis.verdict}: {', '.join(named) or 'nothing'}; held out {held_out:.3f}")
    print(f"{wall:.0f} s, {cpu:.0f} s of the processor, at most {_peak_gib():.2f} GiB")
    return 0 if named == hidden else 1


def _peak_gib() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / GIB_IN_KIB


if __name__ == "__main__":
    sys.exit(main())
