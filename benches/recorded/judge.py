"""What an answer is worth against what was hidden, and which artefacts were found."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

OUTCOMES = ("right", "tied", "named falsely", "unexplained", "missed", "failed")

FAIR = {"skew": {"time_delay"}}
"""Names that are true of an artefact: a late force is late, whoever made it so."""

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
"""The kinds of finding that say what an artefact did; any of them will do. `off_grid` has none."""

ALWAYS_FAIR = {"unsettled_start"}
"""True of every campaign here."""


def judge(
    effects: Collection[str],
    artefacts: Iterable[str],
    verdict: str,
    named: Sequence[str],
    alternatives: Mapping[str, Sequence[str]],
) -> str:
    """One of `OUTCOMES` but `failed`.

    `right`: exactly what is hidden is named, and what else remains is not said to be unexplained.
    `tied`: `ambiguous`, every hidden effect among the tied names, and not more names than hidden
    effects. `named falsely`: a name that is neither. `unexplained`: nothing false, structure said
    to remain. `missed`: nothing false, and not all of what is hidden.
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
    """Artefacts that a finding tells of; those that none does; findings that tell of nothing done.

    Artefacts that no finding can tell of (`off_grid`) are in neither list.
    """
    said = set(kinds)
    can = [name for name in artefacts if name in FOUND_AS]
    told = [name for name in can if FOUND_AS[name] & said]
    silent = [name for name in can if name not in told]
    true = ALWAYS_FAIR.union(*(FOUND_AS[name] for name in can))
    return told, silent, sorted(said - true)
