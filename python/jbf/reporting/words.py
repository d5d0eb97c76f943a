"""Sentences and number formats shared by the text reports, the HTML pages and the command line."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from statistics import median
from typing import TYPE_CHECKING

from jbf.models.catalogue import find_law
from jbf.models.number_format import BASE_LAW as BASE_LAW
from jbf.models.number_format import measured as measured
from jbf.models.number_format import number as number
from jbf.models.number_format import percent as percent
from jbf.models.number_format import step_words
from jbf.models.number_format import value_and_error as value_and_error

if TYPE_CHECKING:
    from jbf.comparison.comparison import Comparison
    from jbf.diagnosis.ledger import Remainder
    from jbf.diagnosis.result import Diagnosis
    from jbf.models.model import Model


def listed(words: Iterable[str], last: str = "and") -> str:
    """Join words as `a`, `a and b` or `a, b and c`."""
    items = list(words)
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {last} {items[-1]}"


def not_tested_rows(not_tried: Mapping[str, str]) -> list[tuple[str, str]]:
    """Return rows of names and reasons; names with the same reason share a row."""
    names: dict[str, list[str]] = {}
    for name, reason in not_tried.items():
        names.setdefault(reason, []).append(name)
    return [(", ".join(group), reason) for reason, group in names.items()]


def omitted_words(diagnosis: Diagnosis) -> str:
    """Name what exceeded the budget or the time limit, with the reason; empty if nothing did."""
    omitted: dict[str, list[str]] = {}
    for name in diagnosis.unfinished:
        omitted.setdefault(diagnosis.not_tried[name], []).append(name)
    return "; ".join(f"{_shortened(names)} ({reason})" for reason, names in omitted.items())


def _shortened(names: Sequence[str]) -> str:
    """Join names, at most the first four."""
    more = [f"{len(names) - 4} more"] if len(names) > 4 else []
    return listed([*names[:4], *more])


def law_words(model: Model, join: str = " (") -> str:
    """Name the law of a model, with the film's time scale (`clock`) if the law has a film."""
    if not find_law(model.law).has_film:
        return model.law
    return f"{model.law}{join}clock {model.clock}" + (")" if "(" in join else "")


def law_and_effects(model: Model) -> str:
    """Write a model as a sum: the law, then its effects."""
    return " + ".join([law_words(model), *model.effects])


UNKNOWN = "unknown"
SHOWN_SHARE = 0.2
"""Share of the motion's errors in the mean square, or of coloured noise in the variance of the
noise, from which a summary states it."""


def noise_words(noise_rms: float, unit: str) -> str:
    """Format a noise floor with its unit; `not known` if it is zero."""
    return f"{number(noise_rms)} {unit}" if noise_rms > 0.0 else UNKNOWN


def times(error_n: float, noise_rms: float) -> str:
    """Format an error as a multiple of the noise floor: `1.29 times`."""
    return f"{error_n / noise_rms:.2f} times" if noise_rms > 0.0 else "above"


def against_noise(error_n: float, noise_rms: float, unit: str = "") -> str:
    """Format an error as a multiple of the noise floor: `1.29 times the noise of 0.5 N`.

    Without a unit, the size of the noise is omitted.
    """
    if not noise_rms > 0.0:
        return f"the noise is {UNKNOWN}"
    size = f" of {number(noise_rms)} {unit}" if unit else ""
    return f"{times(error_n, noise_rms)} the noise{size}"


def comparison_sentence(comparison: Comparison) -> str:
    """State the RMS error of a model, and its ratio to the noise floor."""
    rms, noise = comparison.rms, comparison.noise_rms
    unit = comparison.model.rig.quantities.force
    if not noise > 0.0:
        return f"RMS {number(rms)} {unit}, {against_noise(rms, noise)}"
    return (
        f"RMS {number(rms)} {unit} against a noise floor of {noise_words(noise, unit)}: "
        f"{against_noise(rms, noise)}"
    )


def verdict_sentence(diagnosis: Diagnosis, place: str = " below") -> str:
    """State the result of the diagnosis with all its qualifications.

    Parameters
    ----------
    place
        Where further residual structure is listed, relative to this text.
    """
    return (
        conclusion(diagnosis, place)
        + _unconfirmed_sentence(diagnosis)
        + _confounders_sentence(diagnosis.confounders)
        + drive_sentences(diagnosis)
        + _coloured_noise_sentence(diagnosis)
        + law_sentence(diagnosis)
    )


def headline_and_rest(diagnosis: Diagnosis) -> tuple[str, str]:
    """Split the verdict into a headline and the remaining sentences."""
    verdict = verdict_sentence(diagnosis)
    if diagnosis.verdict == "unexplained":
        reason = f"{_INCOMPLETE if _unfinished_searches(diagnosis) else _STRUCTURE}."
        if diagnosis.effects:
            rest = verdict.partition(". ")[2]
            return f"Missing: {listed(diagnosis.effects)}. {reason}", rest
        return reason, verdict
    if diagnosis.verdict == "adequate":
        return "Nothing is missing.", verdict
    first, stop, rest = verdict.partition(". ")
    return f"{first}." if stop else verdict, rest


def _unconfirmed_sentence(diagnosis: Diagnosis) -> str:
    """Name effects that fit better but were not confirmed by held-out runs.

    Such effects are too weak to be part of the verdict.
    """
    if diagnosis.verdict not in ("adequate", "missing"):
        return ""
    unconfirmed = [
        t for t in diagnosis.steps[-1].trials if t.outcome == "rejected" and t.evidence > 0.0
    ]
    if not unconfirmed or any(t.outcome == "added" for t in diagnosis.steps[-1].trials):
        return ""
    names = listed(t.effect for t in unconfirmed)
    return f" Improves the fit, but held-out runs do not confirm it, so it is not named: {names}."


def drive_sentences(diagnosis: Diagnosis) -> str:
    """State the shares of the runs' deviations and of the motion's errors in the mean square.

    Also states which effects fit as well as a machine term. A share below `SHOWN_SHARE` is
    omitted, and that of the motion's errors also if forces that the model lacks increase it.
    """
    samples, sentences = diagnosis.after.samples, []
    between = _share_between_runs(diagnosis)
    if between >= SHOWN_SHARE:
        percent = f"{100.0 * between:.0f} %"
        sentences.append(
            f"About {percent} of the mean square is due to differences between the runs."
        )
    share = 0.0 if samples.motion is None else samples.motion.variance_share(samples.weight)
    too_large = any(r.axis in ("motion", "momentum") for r in diagnosis.residual_structure)
    if samples.motion is not None and share >= SHOWN_SHARE and not too_large:
        # All shares are those of the whole mean square.
        share *= 1.0 - between
        if not diagnosis.residual_structure:  # the residual has no other part
            noise_share = (samples.motion.noise / diagnosis.steps[-1].rms) ** 2
            share = max(share, 1.0 - between - noise_share)
        percent = f"{100.0 * share:.0f} %"
        sentences.append(
            f"About {percent} of the mean square is due to errors of the estimated motion."
        )
    sentences += [
        f"In these runs {name} cannot be distinguished from {listed(alternatives, 'or')}."
        for name in diagnosis.machine
        if (alternatives := diagnosis.alternatives.get(name, ()))
    ]
    return "".join(f" {sentence}" for sentence in sentences)


def _share_between_runs(diagnosis: Diagnosis) -> float:
    """Share of the estimated deviations of the runs in the mean square of the residual, 0 to 1."""
    samples, residuals = diagnosis.after.samples, diagnosis.after.residuals
    within = samples.without_deviations(residuals, diagnosis.fit.noise)
    return max(0.0, 1.0 - (samples.rms(within) / max(samples.rms(residuals), 1e-300)) ** 2)


def _coloured_noise_sentence(diagnosis: Diagnosis) -> str:
    """State the share of coloured noise; empty if it is below `SHOWN_SHARE` of the variance."""
    noise = diagnosis.fit.noise
    steps_s = [p.step_s for p in diagnosis.after.campaign.prepared]
    share = noise.coloured_share(median(steps_s))
    if share < SHOWN_SHARE:
        return ""
    return (
        f" About {100.0 * share:.0f} % of the variance of the noise has a correlation time of "
        f"{number(noise.memory_s, 2)} s, as with slowly varying loads or a filtered sensor."
    )


def law_sentence(diagnosis: Diagnosis) -> str:
    """Name the law selected from the data, or another law that predicts with fewer terms."""
    if diagnosis.laws:
        first, *other_laws = diagnosis.laws
        tied = [rival.law for rival in other_laws if rival.tied]
        words = f" Law selected from the data: {first.law}"
        if tied and not first.tied:
            return f"{words}, which predicts as well as {listed(tied, 'or')} with these effects."
        if tied:
            return f"{words}, the simplest of those that predict equally well ({listed(tied)} too)."
        return f"{words}."
    rival = diagnosis.simpler_law
    if rival is None:
        return ""
    held_out_rms, unit = diagnosis.steps[-1].held_out_rms, diagnosis.model.rig.quantities.force
    return (
        f" The law {rival.law} without further friction effects predicts held-out runs within "
        f"{number(rival.held_out_rms)} {unit} (the model above: {number(held_out_rms)} {unit}); "
        "--law auto compares all laws."
    )


def _with_probabilities(diagnosis: Diagnosis, tied: Sequence[str]) -> str:
    """State that one of several effects explains the records, with their posterior weights."""
    weights = diagnosis.weights.get(tied[0], {})
    words = f"{listed(tied, 'or')} explains the records"
    if not all(effect in weights for effect in tied):
        return words
    probabilities = listed(f"{100.0 * weights[effect]:.0f} %" for effect in tied)
    return f"{words}, with probabilities of {probabilities}"


_STRUCTURE = "The residual has structure that no effect in the catalogue explains"
_UNEXPLAINED = "The residual has structure that no tested effect explains"
_INCOMPLETE = "The search is not complete"


def _unfinished_searches(diagnosis: Diagnosis) -> list[str]:
    """Reasons why the search for effects is not complete."""
    return [r.where for r in diagnosis.residual_structure if r.unfinished]


def _reason(diagnosis: Diagnosis, place: str) -> str:
    """State why a diagnosis is `unexplained`: an incomplete search, or residual structure."""
    searches = _unfinished_searches(diagnosis)
    structure = [r for r in diagnosis.residual_structure if not r.unfinished]
    sentences = [f"{_INCOMPLETE}: {where}." for where in searches]
    if structure or not searches:
        words = _UNEXPLAINED if searches else _STRUCTURE
        sentences.append(f"{words}{_worst(structure, place)}.")
    return " ".join(sentences)


def conclusion(diagnosis: Diagnosis, place: str = " below") -> str:
    """State the verdict of a diagnosis, the held-out error and its ratio to the noise.

    Parameters
    ----------
    place
        Where further residual structure is listed, relative to this text.
    """
    first, last = diagnosis.steps[0], diagnosis.steps[-1]
    unit = diagnosis.model.rig.quantities.force
    held_out_n = last.held_out_rms
    final_error = f"{number(held_out_n)} {unit}, {against_noise(held_out_n, last.noise_rms, unit)}"
    added = listed(diagnosis.effects)
    fall = f"the held-out error falls from {number(first.held_out_rms)} {unit} to {final_error}"
    if diagnosis.verdict == "adequate":
        law = f"the {diagnosis.model.law} law without effects"
        if diagnosis.machine:
            terms = listed(diagnosis.machine)
            law = f"the {diagnosis.model.law} law with {terms}"
        held_out = "runs" if len(diagnosis.before.campaign.prepared) > 1 else "parts of the run"
        return f"Nothing is missing: {law} predicts held-out {held_out} within {final_error}."
    if diagnosis.verdict == "missing":
        return f"Missing: {added}. With {_pronoun(diagnosis.effects)}, {fall}."
    if diagnosis.verdict == "ambiguous":
        ties = "; ".join(
            _with_probabilities(diagnosis, (effect, *alternatives))
            for effect, alternatives in diagnosis.alternatives.items()
            if alternatives and effect in diagnosis.effects
        )
        return (
            f"An effect is missing, but these runs cannot tell which: {ties}. With {added}, {fall}."
        )
    structure = _reason(diagnosis, place)
    if diagnosis.effects:
        return f"Missing: {added}. With {_pronoun(diagnosis.effects)}, {fall}. {structure}"
    return f"{structure} The held-out error is {final_error}."


def _worst(remains: Sequence[Remainder], place: str) -> str:
    """Describe the largest item of residual structure, and count the others."""
    if not remains:
        return ""
    count = f" (and {len(remains) - 1} more{place})" if len(remains) > 1 else ""
    return f": {max(remains, key=lambda r: r.share).where}{count}"


def _confounders_sentence(names: tuple[str, ...]) -> str:
    """Name effects in the model that the verdict omits, with the reason; empty without any."""
    if not names:
        return ""
    lone = len(names) == 1
    return (
        f" The model also contains {listed(names)}, which {'improves' if lone else 'improve'} the "
        f"held-out prediction but {'is' if lone else 'are'} not named, because "
        f"{'it' if lone else 'they'} may describe another mechanism or the error of a formula."
    )


def _pronoun(effects: tuple[str, ...]) -> str:
    return "it" if len(effects) == 1 else "them"


def step_name(diagnosis: Diagnosis, index: int) -> str:
    """Name what step `index` of the ledger added: the base law, or `+ effect`."""
    return step_words([step.effects for step in diagnosis.steps], index)


def held_out_sentence(diagnosis: Diagnosis) -> str:
    """Describe how the held-out error was computed."""
    runs = len(diagnosis.before.campaign.prepared)
    if runs == 1:
        return "Held out: alternate parts of the run, predicted by fits to the other parts."
    if diagnosis.steps[-1].extrapolations:
        return (
            "Held out: each run is predicted by a fit to the other runs; of runs beyond their "
            "range, alternate parts."
        )
    return "Held out: each run is predicted by a fit to the other runs."


def extrapolation_sentences(diagnosis: Diagnosis) -> list[str]:
    """Describe each run whose speed or load is beyond the range of all others.

    The text states its extrapolation error, and how it is tested.
    """
    unit = diagnosis.model.rig.quantities.force
    return [
        f"{e.run} is outside the range of the other runs ({e.where}). A fit to the others predicts "
        f"it with an RMS error of {number(e.rms)} {unit} (extrapolation). The held-out error uses "
        "alternate parts of this run"
        for e in diagnosis.steps[-1].extrapolations
    ]
