"""Time to predict, differentiate and fit one simulated campaign: `python benches/campaign.py`.

The campaign has six runs (390 s, 50 samples/s) of `simulator/rigsim` with two effects. Times are
wall-clock times measured in Python. `CPU` is the processor time of all threads together, which a
busy machine affects less; on two free cores the wall-clock time is about half of it.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import jbf
import numpy as np
from jbf import _core
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.models.chain import MAX_STEP_S, core_bearing, core_load_n

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "simulator"))

import rigsim
from rigruns import simulated

EFFECTS = ("coulomb_drag", "sensor_lag")
FINE_STEP_S, FINEST_STEP_S = 0.002, 0.0005


def campaign(seed: int) -> tuple[jbf.Rig, list[jbf.Run]]:
    """Return a rig and its six runs: reversing and unidirectional sines, and stop-and-go."""
    full = {m.name: m for m in rigsim.standard("full").motions}
    motions = (
        rigsim.sine("bi_w0.10", 95.0, 0.127, 0.1),
        *(full[n] for n in ("bi_w0.25", "bi_w1.0", "bi_w2.0", "uni_w0.25", "stopgo")),
    )
    plan = rigsim.Campaign("bench", motions)
    rig, runs, _ = simulated(seed, EFFECTS, campaign=plan)
    return rig, runs


def timed(work: Callable[[], object], rounds: int) -> tuple[float, float, float]:
    """Return median and shortest wall-clock time and shortest processor time of `work`, ms."""
    wall, cpu = [], []
    for _ in range(rounds):
        begin, begun = time.perf_counter(), time.process_time()
        work()
        wall.append(time.perf_counter() - begin)
        cpu.append(time.process_time() - begun)
    return 1e3 * float(np.median(wall)), 1e3 * min(wall), 1e3 * min(cpu)


def row(name: str, times: tuple[float, float, float], share: int | None = None) -> None:
    """Print a table row of times, and the processor time divided by `share` parameters."""
    each = "" if share is None else f"{times[2] / share:.2f}"
    print(f"| {name} | {times[0]:.1f} | {times[1]:.1f} | {times[2]:.1f} | {each} |")


def main() -> None:
    """Measure the campaign and print a table of times."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--seed", type=int, default=3)
    options = parser.parse_args()
    rig, runs = campaign(options.seed)
    prepared = Campaign.prepare(rig, runs)
    problem = Problem(prepared, "journal", "journal", EFFECTS)
    fitted = jbf.fit(rig, runs, EFFECTS)
    values, motions = fitted.model.values, [driven.motion for driven in prepared.motions]
    count = len(values)

    def chain(step_s: float) -> _core.Chain:
        return _core.Chain(
            law="journal",
            bearing=core_bearing(rig),
            load_n=core_load_n(rig),
            clock="journal",
            effects=list(problem.effects),
            max_step_s=step_s,
        )

    def predicted(step_s: float) -> tuple[np.ndarray, np.ndarray]:
        rows = chain(step_s).jacobian(values, motions, list(range(count)))
        return np.concatenate([f for f, _ in rows]), np.concatenate([j for _, j in rows])

    seconds = sum(float(r.time_s[-1] - r.time_s[0]) for r in runs)
    print(f"{len(runs)} runs, {seconds:.0f} s, {sum(map(len, runs))} samples, {count} parameters")
    exact, slopes = predicted(FINEST_STEP_S)
    print(f"\nError against steps of {FINEST_STEP_S * 1e3:g} ms, share of the peak, RMS:")
    for step_s in (MAX_STEP_S, FINE_STEP_S):
        f, j = predicted(step_s)
        error = np.sqrt(np.mean((f - exact) ** 2)) / np.max(np.abs(exact))
        worst = np.max(np.sqrt(np.mean((j - slopes) ** 2, 0)) / np.max(np.abs(slopes), 0))
        print(f"  {step_s * 1e3:g} ms: friction {error:.1e}, worst derivative {worst:.1e}")
    print("\n| | median, ms | least | CPU, least | CPU a parameter |\n|---|---|---|---|---|")
    for step_s in (MAX_STEP_S, FINE_STEP_S):
        core = chain(step_s)
        what = f"inner step {step_s * 1e3:g} ms"
        row(f"prediction, {what}", timed(lambda c=core: c.predict(values, motions), options.rounds))
        for k in (1, 2, 4, count):
            columns = list(range(k))
            times = timed(lambda c=core, k=columns: c.jacobian(values, motions, k), options.rounds)
            row(f"and derivatives by {k}, {what}", times, k)
    fits = max(options.rounds // 3, 3)
    row("records made ready", timed(lambda: Campaign.prepare(rig, runs), fits))
    row(f"`jbf.fit`, {count} parameters", timed(lambda: jbf.fit(rig, runs, EFFECTS), fits))
    print(f"\nThe fit: converged {fitted.converged}, RMS {fitted.rms:.4f} N ({fitted.message})")


if __name__ == "__main__":
    main()
