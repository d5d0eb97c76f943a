"""Time that the workbench needs to draw: `python benches/workbench_drawing.py`.

A recording of a million samples (and a model of it) in a headless browser without a graphics
processor. Measures the time from the click to the frame with all plots of "Explore", and the
time for a brush in the friction-speed plane. Prints least, median and worst of `--times`, in
milliseconds. With `--most 300 100` it fails if even the least time of a first draw or of a brush is
longer; the other times depend on the load of the machine. Needs Chromium (Debian: `apt-get install
chromium`) and `pip install playwright`.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import jbf
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python" / "tests"))

from workbench_walk import examine_runs, served, why_not

if TYPE_CHECKING:
    from playwright.sync_api import Page

ACT = """async (act) => {
  const before = document.body.dataset.draws ?? "";
  const frame = () => new Promise(requestAnimationFrame);
  const canvas = document.querySelector("#section canvas.mine");
  const at = (type, x, y) => {
    const r = canvas.getBoundingClientRect(), buttons = type === "pointerup" ? 0 : 1;
    const where = { clientX: r.x + x, clientY: r.y + y, bubbles: true, pointerId: 1 };
    canvas.dispatchEvent(new PointerEvent(type, { ...where, buttons }));
  };
  const begun = performance.now();
  if (act === "see") document.querySelector("[data-key=tab-Explore]").click();
  else {
    const x = 150 + 60 * Math.random();
    at("pointerdown", x, 60); at("pointermove", x + 80, 200); at("pointerup", x + 80, 200);
  }
  while ((document.body.dataset.draws ?? "") === before) await frame();
  await frame();
  return performance.now() - begun;
}"""
WAYS = ("first draw", "first draw, with a model", "brush", "brush, with a model")


def recording(folder: Path, samples: int) -> None:
    """Write a recording of a slide with a hidden mass, sampled at 1 kHz."""
    t = 0.001 * np.arange(samples)
    w = 2.0 * np.pi / 7.0
    v = 0.08 * np.sin(w * t) * (1.0 + 0.3 * np.sin(0.01 * t))
    noise = 0.3 * np.random.default_rng(1).standard_normal(samples)
    force = 12.0 * np.sign(v) + 40.0 * v + 3.0 * np.gradient(v, t) + noise
    (folder / "rig.toml").write_text('[drive]\nmotion = "linear"\nfriction = "force"\n')
    jbf.Run.from_arrays(t, v, force, name="long").write_csv(folder / "long.csv")


def drawn(page: Page, act: str) -> float:
    """Return the time from an action in the page to the frame that shows its result, ms."""
    return float(
        page.evaluate(
            ACT,
            act,
        )
    )


def measured(page: Page, times: int) -> dict[str, list[float]]:
    """Measure the drawing times of all cases, each `times` times, ms."""
    times_ms: dict[str, list[float]] = {case: [] for case in WAYS}
    for model in ("", ", with a model"):
        if model:
            page.click("[data-key=tab-Model]")
            page.select_option("[data-key=law]", "coulomb")
            page.wait_for_selector("[data-key=fit-law]:enabled")
            page.click("[data-key=fit-law]")
            page.wait_for_selector("#models [data-key^=model-]", timeout=600_000)
            # Cancel the search for further effects, so that the processor is free.
            page.click("[data-key=cancel]")
            page.wait_for_selector("[data-key=cancel]", state="detached", timeout=120_000)
        for _ in range(times):
            page.click("[data-key=tab-Data]")
            page.wait_for_selector("[data-drawn] canvas")
            times_ms["first draw" + model].append(drawn(page, "see"))
            times_ms["brush" + model].append(drawn(page, "brush"))
            page.keyboard.press("Escape")
            page.wait_for_timeout(300)
        for case in (f"first draw{model}", f"brush{model}"):
            each = times_ms[case]
            line = f"{case:28}{np.min(each):8.0f}{np.median(each):8.0f}{np.max(each):8.0f}"
            print(line, flush=True)
    return times_ms


def main() -> int:
    """Measure the drawing times and print them."""
    parser = argparse.ArgumentParser(prog="workbench_drawing", description=__doc__.split(":")[0])
    parser.add_argument("--samples", type=int, default=1_000_000)
    parser.add_argument("--times", type=int, default=7)
    parser.add_argument("--most", type=float, nargs=2, metavar=("FIRST", "BRUSH"))
    options = parser.parse_args()
    if why_not() is not None:
        print(f"SKIPPED: {why_not()}")
        return 0
    print(
        f"{options.samples} samples, {options.times} times: least, median and worst, ms", flush=True
    )
    with tempfile.TemporaryDirectory() as folder:
        recording(Path(folder), options.samples)
        with served(Path(folder)) as address, examine_runs(address) as (page, messages):
            page.click('[data-key="open-rig.toml"]')
            page.wait_for_selector("[data-drawn] canvas", timeout=600_000)
            times_ms = measured(page, options.times)
            assert not messages.complaints, messages.complaints
    most = options.most or (np.inf, np.inf)
    slow = [case for case, each in times_ms.items() if np.min(each) > most["brush" in case]]
    if slow:
        print(
            f"FAILED: longer than {options.most[0]:g} and {options.most[1]:g} ms: {', '.join(slow)}"
        )
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
