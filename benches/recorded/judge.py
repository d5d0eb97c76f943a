"""Assessment of a diagnosis against the hidden effects and the simulated recording artefacts."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

OUTCOMES = ("right", "tied", "named falsely", "unexplained", "missed", "failed")

FAIR = {"skew": {"time_delay"}}
"""Effects that correctly describe an artefact; a delayed force is a delay, whatever its cause."""

FOUND_AS: dict[str, set[str]] = {
    "backward_velocity": {"coarse_speed", "filtered_speed", "late_speed", "late_channel"},
    "coarse_velocity": {"coarse_speed", "filtered_speed", "late_speed"},
    "drifting_clock": {"drifting_clock", "late_channel"},
    "dropout": {"held_samples"},
    "filtered_velocity": {"filtered_speed", "late_speed", "late_channel"},
    "gain_by_run": {"gain_by_run"},
    "gaps": {"gaps"},
    "heavy_tails": {"heavy_tails", "glitches"},
    "jitter": {"jitter"},
    "long_memory": {"long_memory", "level_by_run", "drift_by_run"},
    "noise_by_run": {"noise_by_run"},
    "noise_with_force": {"noise_with_force"},
    "noisy_load": {"noisy_load"},
    "position_glitch": {"glitches"},
    "quantised": {"steps"},
    "retared": {"level_by_run"},
    "runs_differ": {"level_by_run", "gain_by_run", "oil_by_run"},
    "saturation": {"saturation"},
    "skew": {"late_channel"},
    "slow_force": {"interpolated", "held_samples"},
    "spikes": {"glitches"},
}
"""Kinds of finding that report an artefact correctly, any of them; None for `off_grid`."""

ALWAYS_FAIR = {"unsettled_start"}
"""Kinds of finding that are true of every campaign in this study."""


def judge(
    effects: Collection[str],
    artefacts: Iterable[str],
    verdict: str,
    named: Sequence[str],
    alternatives: Mapping[str, Sequence[str]],
) -> str:
    """Assess the effects that a diagnosis names as one of `OUTCOMES` except `failed`.

    - `right`: exactly the hidden effects are named, and no unexplained structure is reported.
    - `tied`: `ambiguous`, every hidden effect is among the tied names, and there are not more names
      than hidden effects.
    - `named falsely`: a name that is neither.
    - `unexplained`: no false name, remaining structure is reported.
    - `missed`: no false name, and not all hidden effects are named.
    """
    fair = set().union(*(FAIR.get(name, set()) for name in artefacts))
    truth = set(effects)
    given = {name for name in named if name in truth or name not in fair}
    tied = verdict == "ambiguous" and any(alternatives.values())
    if tied and truth and len(given) <= len(truth):
        others = {name for names in alternatives.values() for name in names}
        if truth <= given | others:
            return "tied"
    if given - truth:
        return "named falsely"
    if verdict == "unexplained":
        return "unexplained"
    return "right" if given == truth else "missed"


def found(artefacts: Iterable[str], kinds: Iterable[str]) -> tuple[list[str], list[str], list[str]]:
    """Compare the artefacts of a campaign with the kinds of the reported findings.

    Returns the artefacts that a finding reports, those that none reports, and the false findings.

    Artefacts that no finding can report (`off_grid`) are in none of the lists.
    """
    reported = set(kinds)
    can = [name for name in artefacts if name in FOUND_AS]
    detected = [name for name in can if FOUND_AS[name] & reported]
    silent = [name for name in can if name not in detected]
    true = ALWAYS_FAIR.union(*(FOUND_AS[name] for name in can))
    return detected, silent, sorted(reported - true)
