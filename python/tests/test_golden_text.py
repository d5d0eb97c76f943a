"""What people read of results put together by hand, to the letter."""

from __future__ import annotations

from dataclasses import replace
from textwrap import dedent

import numpy as np
import pytest
from by_hand import TRIALS, comparison_by_hand, diagnosis_by_hand, fit_by_hand
from jbf import Run
from jbf.diagnosis import Remainder
from jbf.diagnosis.ledger import Trial
from jbf.records.counts import count_of
from jbf.records.findings.gaps import find_gaps
from jbf.reporting.comparison_text import comparison_report
from jbf.reporting.diagnosis_page import diagnosis_page
from jbf.reporting.diagnosis_text import diagnosis_report
from jbf.reporting.fit_text import fit_report
from jbf.reporting.words import verdict_sentence


def said(text: str) -> str:
    """A text as it stands in a test, without the test's indentation."""
    return dedent(text).strip("\n")


def test_the_report_of_a_fit() -> None:
    assert fit_report(fit_by_hand(["sensor_offset"], doubtful=("F_c_n",))) == said("""
        [[Fit]]
            law                    = coulomb
            effects                = sensor_offset
            runs                   = 2
            samples                = 1001
            RMS of the residual    = 0.525 N
            noise in the residual  = coloured, share 0.25, memory 0.15 s
            search                 = converged
        [[Parameters]]
            F_c_n                       4.988  +/- 0.012  (0.25 %)  N
            F_s_n              held at 6.0000                       N      (held fixed)
            F_v_n_s_m                   20.44   +/- 0.52   (2.5 %)  N s/m
            sensor_offset.b_n          -0.250  +/- 0.025    (10 %)  N
            note: of F_c_n the likelihood is no parabola within these errors, so they may be far too
                  small. `jbf fit --bootstrap 40` (jbf.bootstrap) finds theirs.
        [[Correlations]] (those above 0.3)
            C(F_c_n, F_v_n_s_m)          = -0.900
            C(F_c_n, sensor_offset.b_n)  = +0.450
    """)


def test_correlations_where_nothing_is_held() -> None:
    held = fit_by_hand(["sensor_offset"])
    open_ = {n: p for n, p in held.parameters.items() if not p.held}
    lines = replace(held, parameters=open_).report().splitlines()
    assert [line for line in lines if line.startswith("    C(")] == [
        "    C(F_c_n, F_v_n_s_m)          = -0.900",
        "    C(F_c_n, sensor_offset.b_n)  = +0.450",
    ]


def test_the_summary_of_a_comparison() -> None:
    assert comparison_report(comparison_by_hand(1.25, (1.0, 1.5))) == said("""
        RMS 1.25 N against a noise floor of 0.500 N: 2.50 times the noise

        Where it fails (share of the mean square)
            direction   60 %  record above the model

        Runs
            run    samples  RMS (N)  RMS / noise
            there      501     1.00         2.00
            back       500     1.50         3.00
    """)


def test_the_summary_of_a_diagnosis() -> None:
    assert diagnosis_report(diagnosis_by_hand("missing")) == said("""
        Verdict: missing
          Missing: sensor_offset. With it, the held-out error falls from 2.75 N to 0.550 N, 1.10
          times the noise of 0.500 N.

        Measurement
            2 runs of 20 s in all, 1002 samples where the sign of the motion is known
            noise floor 0.500 N, estimated from the records alone

        The bare law (coulomb)
            misses by 2.50 N RMS, 5.00 times the noise; where it fails (share of the mean square):
            direction   60 %  record above the model

        Candidates tried beside the bare law
            effect         RMS (N)  evidence  outcome   why
            sensor_offset    0.525      +812  added     largest evidence
            sensor_drift      1.50       +55  ties      fits as well as sensor_offset
            inertia_leak      2.00        +7  rejected  sensor_offset leads by 805
            sensor_lag        2.50       -26  no gain   gains no more than chance would

        Not tried: these runs cannot show
            position_ripple: not every run has the shaft's angle

        The error falling (N)
            step               fit  held out  noise  held out / noise
            bare law          2.50      2.75  0.500              5.50
            + sensor_offset  0.525     0.550  0.500              1.10

        What remains
            nothing that stands above the noise

        Parameters of the final model
            F_c_n                       4.988  +/- 0.012  (0.25 %)  N
            F_s_n              held at 6.0000                       N      (held fixed)
            F_v_n_s_m                   20.44   +/- 0.52   (2.5 %)  N s/m
            sensor_offset.b_n          -0.250  +/- 0.025    (10 %)  N
    """)


HEADS = {
    "adequate": """
        Verdict: adequate
          Nothing is missing: the bare coulomb law predicts runs that it was not fitted to within
          2.75 N, 5.50 times the noise of 0.500 N.
    """,
    "ambiguous": """
        Verdict: ambiguous
          Something is missing, and these runs cannot tell which: sensor_offset (62 %) or
          sensor_drift (38 %). With sensor_offset, the held-out error falls from 2.75 N to 0.550 N,
          1.10 times the noise of 0.500 N; the alternatives do as well.
          Next experiment: record a rest
    """,
    "unexplained": """
        Verdict: unexplained
          Something remains that no effect in the catalogue explains: a 3.00 Hz tone (and 1 more
          below). The held-out error is 2.75 N, 5.50 times the noise of 0.500 N.
    """,
}


@pytest.mark.parametrize("verdict", list(HEADS))
def test_what_each_verdict_says(verdict: str) -> None:
    head = diagnosis_by_hand(verdict).summary().partition("\n\n")[0]
    assert head == said(HEADS[verdict])


def test_what_is_missing_is_said_beside_what_remains() -> None:
    d = diagnosis_by_hand("missing")
    left = (Remainder("time", "2 bursts", 0.04), Remainder("frequency", "a 3.00 Hz tone", 0.12))
    for remains, words in ((left[:1], "2 bursts."), (left, "a 3.00 Hz tone (and 1 more below).")):
        told = replace(d, verdict="unexplained", unexplained=remains)
        assert verdict_sentence(told) == (
            "Missing: sensor_offset. With it, the held-out error falls from 2.75 N to 0.550 N, "
            "1.10 times the noise of 0.500 N. Besides, something remains that no effect in the "
            f"catalogue explains: {words}"
        )


def test_an_effect_that_helps_and_is_not_named_is_said() -> None:
    d = diagnosis_by_hand("unexplained")
    one, two = (replace(d, confounders=names) for names in (("wear_in",), ("wear_in", "backlash")))
    assert verdict_sentence(one) == verdict_sentence(d) + (
        " The model also has wear_in, with which it predicts runs left out better, but which is "
        "not named: the runs disagree on its parameters."
    )
    assert "wear_in and backlash" in verdict_sentence(two)
    assert "which are not named: the runs disagree on their parameters" in verdict_sentence(two)
    assert "The model also has wear_in" in " ".join(one.summary().split())
    assert "The model also has wear_in" in diagnosis_page(one)


def test_one_of_a_thing_is_one_thing() -> None:
    assert [count_of(n, "run") for n in (0, 1, 2)] == ["0 runs", "1 run", "2 runs"]
    assert [count_of(n, "row is", "rows are") for n in (1, 2)] == ["1 row is", "2 rows are"]
    t = np.delete(np.arange(0.0, 10.0, 0.02), 100)
    (gap,) = find_gaps(Run.from_arrays(t, 0.1 + 0.0 * t, 5.0 + np.sin(t), name="a"))
    assert gap.words.startswith("1 row is missing")


def test_what_could_hide_is_said() -> None:
    sections = diagnosis_by_hand("adequate").summary().split("\n\n")
    assert "Could be there at a usual strength and hide in these runs\n    backlash" in sections
    assert not any("where it fails" in section for section in sections)


def test_what_remains_is_named() -> None:
    sections = diagnosis_by_hand("unexplained").summary().split("\n\n")
    (remains,) = [s for s in sections if s.startswith("What remains")]
    assert remains == said("""
        What remains
            frequency   12 %  a 3.00 Hz tone
            time         4 %  2 bursts
    """)


def test_what_runs_left_out_did_not_confirm_is_said() -> None:
    d = diagnosis_by_hand("adequate")
    doubted = Trial("time_delay", 2.4, 31.0, "rejected", "fits better but predicts no better")
    (bare,) = d.steps
    told = replace(d, steps=(replace(bare, trials=(doubted, *bare.trials)),))
    said_of_it = "runs left out do not confirm it, so it is not named: time_delay."
    assert verdict_sentence(told).endswith(said_of_it)
    assert "confirm" not in verdict_sentence(d)
    # Beside one that was added it is that round's, and not the end's.
    added = replace(bare, trials=(TRIALS[0], doubted))
    assert "confirm" not in verdict_sentence(replace(d, steps=(added,)))
