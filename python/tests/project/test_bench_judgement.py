"""Classification of diagnoses in the validation suite of recorded campaigns."""

from typing import Any

import pytest
from recorded.judge import FOUND_AS, OUTCOMES, found, judge
from rigsim.recording import ARTEFACTS

TIED = {"coulomb_drag": ["sensor_offset"]}


@pytest.mark.parametrize(
    ("hidden", "artefacts", "verdict", "named", "tied", "outcome"),
    [
        ((), ("spikes",), "adequate", [], {}, "right"),
        ((), ("spikes",), "missing", ["running_in"], {}, "named falsely"),
        ((), ("spikes",), "unexplained", [], {}, "unexplained"),
        ((), ("skew",), "missing", ["time_delay"], {}, "right"),
        ((), ("spikes",), "missing", ["time_delay"], {}, "named falsely"),
        ((), ("gaps",), "ambiguous", ["coulomb_drag"], TIED, "named falsely"),
        (("coulomb_drag",), ("gaps",), "missing", ["coulomb_drag"], {}, "right"),
        (("coulomb_drag",), ("gaps",), "unexplained", ["coulomb_drag"], {}, "unexplained"),
        (("coulomb_drag",), ("gaps",), "adequate", [], {}, "missed"),
        (("sensor_offset",), ("gaps",), "ambiguous", ["coulomb_drag"], TIED, "tied"),
        (("coulomb_drag",), ("gaps",), "ambiguous", ["coulomb_drag"], TIED, "tied"),
        (("running_in",), ("gaps",), "ambiguous", ["coulomb_drag"], TIED, "named falsely"),
        (("running_in",), ("skew",), "missing", ["running_in", "time_delay"], {}, "right"),
        (("time_delay",), ("skew",), "missing", ["time_delay"], {}, "right"),
        (("a", "b"), ("gaps",), "missing", ["a"], {}, "missed"),
        (("a", "b"), ("gaps",), "missing", ["a", "c"], {}, "named falsely"),
    ],
)
def test_outcome_of_a_diagnosis_is_determined_by_verdict_and_hidden_effects(
    hidden: Any, artefacts: Any, verdict: str, named: Any, tied: Any, outcome: str
) -> None:
    assert judge(hidden, artefacts, verdict, named, tied) == outcome
    assert outcome in OUTCOMES


def test_recording_findings_are_classified_as_reported_missed_or_false() -> None:
    classes = found(("spikes", "gaps", "off_grid"), ["glitches", "jitter"])
    assert classes == (["spikes"], ["gaps"], ["jitter"])
    assert found(("off_grid",), ["unsettled_start"]) == ([], [], [])


def test_every_simulated_artefact_is_assigned_to_a_finding() -> None:
    assert set(FOUND_AS) == set(ARTEFACTS)
