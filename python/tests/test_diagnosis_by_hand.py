"""Diagnoses of linear campaigns, whose every number a textbook gives: evidence, hold-out, verdicts.

Friction is Coulomb's on motions that never turn round, so a model is a matrix of few columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from by_hand import Array, Friction, coulomb, four_runs, wandering
from jbf import Diagnosis, Rig, Run, diagnose, effects
from jbf.diagnosis import Trial
from jbf.diagnosis.candidates import Candidates
from jbf.estimation.solution import Solution
from jbf.reporting.words import verdict_sentence
from scipy import stats

NOISE_N = 0.1
RECORDED = {"angle", "path", "position", "loads", "temperatures"}
CANDIDATES = sum(
    "coulomb" not in e.refused and not RECORDED & set(e.needs) for e in effects().values()
)
"""Effects that go with Coulomb's law and need nothing recorded beside the motion."""


@cache
def diagnosed(hidden: str) -> tuple[Diagnosis, list[Run]]:
    """A campaign and its diagnosis."""

    def weak_mass(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + 0.06 * a

    def mass(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + 3.0 * a

    def lag(t: Array, v: Array, a: Array) -> Array:
        # To first order in the time, a lag and a delay are the same.
        return coulomb(t, v, a) - 0.005 * 20.0 * a

    def small_tone(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + 0.5 + 0.24 * np.sin(2.0 * np.pi * 3.0 * t)

    def large_tone(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + 0.5 + 0.46 * np.sin(2.0 * np.pi * 3.0 * t)

    plans: dict[str, tuple[Friction, float]] = {
        "nothing": (coulomb, NOISE_N),
        "weak mass": (weak_mass, NOISE_N),
        "mass": (mass, NOISE_N),
        "lag": (lag, 0.05),
        "small tone": (small_tone, 0.3),
        "large tone": (large_tone, 0.3),
    }
    if hidden == "mass in one run":
        runs = [
            wandering("a", lambda t, v, a: coulomb(t, v, a) + 3.2 * a, way=1.0, rate=12.0,
                      noise_n=NOISE_N, seed=0),
            *four_runs(coulomb, noise_n=NOISE_N)[1:],
        ]  # fmt: skip
    else:
        runs = four_runs(plans[hidden][0], noise_n=plans[hidden][1])
    return diagnose(Rig(), runs, law="coulomb"), runs


class Textbook:
    """Least squares of runs on direction, speed and acceleration."""

    def __init__(self, runs: list[Run]) -> None:
        # Motions are the same whatever friction was recorded.
        moved = four_runs(lambda t, v, a: a, noise_n=0.0)
        self.x = [
            np.stack([np.sign(r.velocity_m_s), r.velocity_m_s, np.asarray(m.friction_n)], 1)
            for r, m in zip(runs, moved, strict=True)
        ]
        self.y = [np.asarray(run.friction_n) for run in runs]
        self.samples = sum(map(len, self.y))

    def left(self, columns: int, seen: list[int], asked: list[int]) -> float:
        """Sum of squares in some runs of a model fitted to others."""
        x = np.concatenate([self.x[i][:, :columns] for i in seen])
        values = np.linalg.lstsq(x, np.concatenate([self.y[i] for i in seen]), rcond=None)[0]
        return sum(float(np.sum((self.y[i] - self.x[i][:, :columns] @ values) ** 2)) for i in asked)

    def rms(self, columns: int) -> float:
        return float(np.sqrt(self.left(columns, [0, 1, 2, 3], [0, 1, 2, 3]) / self.samples))

    def held_out(self, columns: int) -> float:
        total = sum(self.left(columns, [k for k in range(4) if k != i], [i]) for i in range(4))
        return float(np.sqrt(total / self.samples))


def trial(d: Diagnosis, effect: str, step: int = 0) -> Trial:
    return next(t for t in d.steps[step].trials if t.effect == effect)


def price(parameters: int, samples: int) -> float:
    """What must be gained: more than chance, or a change of 3 % of the residual; for each parameter
    beyond the first log n (Schwarz 1978)."""
    least = max(float(stats.chi2.isf(0.01 / CANDIDATES, 1)) + 22.0, 0.03**2 * samples)
    return least + max(parameters - 1, 0) * float(np.log(samples))


def test_evidence_is_the_gain_less_what_chance_would_gain() -> None:
    d, runs = diagnosed("weak mass")
    book = Textbook(runs)
    gain = 2.0 * book.samples * np.log(book.rms(2) / book.rms(3))
    assert len(d.steps[0].trials) == CANDIDATES
    assert 35.0 < gain < 80.0
    assert trial(d, "inertia_leak").evidence == pytest.approx(
        gain - price(1, book.samples), abs=0.5
    )
    assert d.verdict == "missing"
    assert d.effects == ("inertia_leak",)


def test_a_candidate_at_its_null_is_worth_its_price_and_no_less() -> None:
    d, runs = diagnosed("nothing")
    n = Textbook(runs).samples
    # A candidate that leaves no trace is not fitted, and has no parameters to pay for.
    known = {round(price(k, n), 2) for k in range(4)}
    for t in d.steps[0].trials:
        assert t.outcome == "no gain"
        assert t.evidence < -5.0
        if t.rms_n == d.steps[0].rms_n:
            assert round(-t.evidence, 2) in known, t.effect
    assert trial(d, "sensor_offset").evidence == pytest.approx(-price(0, n), abs=0.01)
    assert d.verdict == "adequate"


@pytest.mark.parametrize("hidden", ["nothing", "weak mass"])
def test_runs_held_out_are_predicted_by_fits_to_the_others(hidden: str) -> None:
    d, runs = diagnosed(hidden)
    book = Textbook(runs)
    for step, columns in zip(d.steps, (2, 3), strict=False):
        # Speeds are taken from a smoothed record, which moves both alike.
        assert step.rms_n == pytest.approx(book.rms(columns), rel=1e-3)
        more = step.holdout_rms_n / step.rms_n - 1.0
        assert more == pytest.approx(book.held_out(columns) / book.rms(columns) - 1.0, rel=0.05)
        assert more > 5e-4


def test_the_leader_says_what_it_predicts_of_runs_left_out() -> None:
    d, runs = diagnosed("weak mass")
    leader = trial(d, "inertia_leak")
    assert leader.outcome == "added"
    assert float(leader.reason.split()[-2]) == pytest.approx(Textbook(runs).held_out(3), rel=1e-3)


@pytest.mark.parametrize("hidden", ["mass", "nothing"])
def test_before_anything_is_left_unexplained_every_candidate_is_fitted(
    hidden: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A mass whose score says nothing of it, as that of a strong effect may."""
    known, runs = diagnosed(hidden)
    asked: list[str] = []

    def silent(self: Candidates, effects: Sequence[str], near: Solution) -> float:
        asked.extend(effects)
        return 0.0

    monkeypatch.setattr(Candidates, "score_test", silent)
    d = diagnose(Rig(), runs, law="coulomb")
    assert "inertia_leak" in asked
    assert (d.verdict, d.effects) == (known.verdict, known.effects)
    assert [s.effects for s in d.steps] == [s.effects for s in known.steps]


def test_what_helps_in_one_run_only_is_not_added() -> None:
    d, runs = diagnosed("mass in one run")
    # What one run gains the others lose: the gain strays by more than itself.
    mass = trial(d, "inertia_leak")
    assert mass.evidence < 0.0
    assert mass.outcome == "no gain"
    assert "fits better" in mass.reason
    book = Textbook(runs)
    assert book.rms(3) < 0.99 * book.rms(2)
    assert book.held_out(3) > book.held_out(2)
    assert d.effects == ()
    # Noise does not reach such a gain anywhere: something of its kind is there, and where.
    assert d.verdict == "unexplained"
    assert d.unexplained[0].axis == "frequency"
    assert d.unexplained[0].where.endswith(f"in {runs[0].name}")
    told = [r.where for r in d.unexplained if r.axis == "run"]
    assert any(w.startswith("inertia_leak fits") and "left out no better" in w for w in told)


def test_effects_that_fit_equally_well_tie() -> None:
    d, _ = diagnosed("lag")
    first, second = d.steps[0].trials[:2]
    assert {first.effect, second.effect} == {"sensor_lag", "time_delay"}
    assert abs(first.evidence - second.evidence) < 3.0
    assert (first.outcome, second.outcome) == ("added", "ties")
    assert d.verdict == "ambiguous"
    assert d.alternatives == {first.effect: (second.effect,)}
    assert d.next_experiment
    weights = d.weights[first.effect]
    odds = np.exp(0.5 * (first.evidence - second.evidence))
    assert weights[first.effect] / weights[second.effect] == pytest.approx(odds, rel=1e-6)
    shares = [f"{e} ({100.0 * weights[e]:.0f} %)" for e in (first.effect, second.effect)]
    assert " or ".join(shares) in " ".join(d.summary().split())


def test_an_effect_that_explains_most_is_kept_beside_a_tone() -> None:
    d, _ = diagnosed("small tone")
    # 0.25 of 0.279 N^2 above the noise are the offset's.
    assert d.verdict == "unexplained"
    assert d.effects == ("sensor_offset",)
    assert [r.axis for r in d.unexplained] == ["frequency"]
    assert d.unexplained[0].where.startswith("a 3.00 Hz tone, amplitude 0.2")
    assert trial(d, "sensor_offset").outcome == "added"
    said = verdict_sentence(d)
    assert said.startswith("Missing: sensor_offset. With it, the held-out error falls from ")
    assert said.endswith(
        f"Besides, something remains that no effect in the catalogue explains: "
        f"{d.unexplained[0].where}."
    )


def test_a_true_effect_keeps_its_name_beside_a_larger_tone() -> None:
    d, _ = diagnosed("large tone")
    # 0.25 of 0.356 N^2 above the noise are the offset's.
    assert d.verdict == "unexplained"
    assert d.effects == ("sensor_offset",)
    assert d.confounders == ()
    assert trial(d, "sensor_offset").outcome == "added"
    assert "frequency" in [r.axis for r in d.unexplained]
    assert d.fit.model.effects == ("sensor_offset",)


def test_what_these_motions_cannot_show_could_hide() -> None:
    d, _ = diagnosed("nothing")
    # Nothing turns round or rests here, and no speed is low.
    assert {"backlash", "dwell_stiction", "presliding"} <= set(d.unseen)
    # Whereas these would have been seen.
    assert not {"inertia_leak", "quadratic_drag", "sensor_drift"} & set(d.unseen)
    assert d.next_experiment
    of_loads = {f"{what}_load_dependence" for what in ("dry", "viscous", "zero")}
    of_places = {"position_ripple", "gravity", "cogging", "pitch_ripple"}
    of_places |= {"cogging_2", "pitch_ripple_2", "stroke_dependence"}
    of_warmth = {f"{what}_temperature_dependence" for what in ("dry", "viscous")}
    assert set(d.not_tried) == {"drive_compliance", *of_places, *of_loads, *of_warmth}
    # And what a gear loses of what it carries is nothing here.
    assert "torque_proportional" not in d.unseen
