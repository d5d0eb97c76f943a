"""Fit, bootstrap and trajectory fit as plain text, 80 to 100 columns wide."""

from __future__ import annotations

from jbf.estimation.bootstrap import Bootstrap
from jbf.estimation.fit import Fit
from jbf.estimation.noise import Noise
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.reporting.effect_words import effect_lines
from jbf.reporting.paragraphs import columns, hanging
from jbf.reporting.tables import LEAST_CORRELATION, correlation_pairs
from jbf.reporting.text_parts import finding_lines, parameter_lines
from jbf.reporting.words import law_words, number

MOST_CORRELATIONS = 10
NOTE_ABOVE = 1.25
"""Ratio of residual RMS to noise floor above which the report adds a note."""
NOTE_BELOW = 0.95
"""Ratio of residual RMS to noise floor below which the report adds a note."""


def noise_words(noise: Noise) -> str:
    """Describe a noise model: `white`, or the share and correlation time of its coloured part."""
    if noise.colour <= 0.0:
        return "white"
    return f"coloured, share {number(noise.colour, 2)}, memory {number(noise.memory_s, 2)} s"


def lines_of_parameters(fit: Fit) -> list[str]:
    """Format one line per parameter of a fit, in the units of the rig."""
    model = fit.model
    return parameter_lines(model.law, model.effects, fit.parameters, model.rig.quantities)


def noise_floor_words(fit: Fit) -> str:
    """Describe the noise floor of the records, and the ratio of the residual RMS to it."""
    if fit.noise_floor is None:
        return "unknown"
    ratio = fit.rms / fit.noise_floor
    return (
        f"{number(fit.noise_floor)} {fit.model.rig.quantities.force} "
        f"(the residual is {number(ratio)} times the noise)"
    )


def fit_report(fit: Fit) -> str:
    """Report a fit: statistics, parameters with standard errors, and strongest correlations."""
    model = fit.model
    facts = [
        ("law", law_words(model)),
        ("effects", ", ".join(model.effects) or "none"),
        ("runs", str(len(fit.residuals))),
        ("samples", str(fit.nobs)),
        ("RMS of the residual", f"{number(fit.rms)} {model.rig.quantities.force}"),
        ("noise of the records", noise_floor_words(fit)),
        ("noise in the residual", noise_words(fit.noise)),
        ("search", "converged" if fit.converged else f"not converged: {fit.message}"),
    ]
    lines = ["[[Fit]]", *columns([(k, f"= {v}") for k, v in facts], "<<", 4)]
    lines += ["[[Parameters]]", *lines_of_parameters(fit)]
    if fit.doubtful:
        names = ", ".join(fit.doubtful)
        lines += hanging(
            "note: ",
            f"the likelihood is not quadratic in {names}, so the standard errors may be far too "
            "small; `jbf fit --bootstrap 40` (jbf.bootstrap) computes reliable ones.",
            4,
        )
    if fit.noise_floor is not None and fit.rms > NOTE_ABOVE * fit.noise_floor:
        lines += hanging(
            "note: ",
            "the residual exceeds the noise of the records: an effect is missing (`jbf "
            "diagnose` identifies it), or the fit ended in a local minimum (choose "
            "other start values: `--start NAME=VALUE`).",
            4,
        )
    if fit.noise_floor is not None and fit.rms < NOTE_BELOW * fit.noise_floor:
        lines += hanging(
            "note: ",
            "the residual is below the noise of the records: their estimate also contains friction "
            "that changes within a few samples, such as a fast ripple.",
            4,
        )
    pairs = correlation_pairs(fit)
    if pairs:
        lines.append(f"[[Correlations]] (absolute value above {LEAST_CORRELATION})")
        correlations = [(f"C({a}, {b})", f"= {c:+.3f}") for a, b, c in pairs[:MOST_CORRELATIONS]]
        lines += columns(correlations, "<<", 4)
        if len(pairs) > MOST_CORRELATIONS:
            lines.append(f"    and {len(pairs) - MOST_CORRELATIONS} smaller ones")
    return "\n".join([*lines, *effect_lines(model), *finding_lines(fit.findings)])


def bootstrap_report(bootstrap: Bootstrap) -> str:
    """Report a fit with bootstrap standard errors."""
    repeats = len(next(iter(bootstrap.values.values())))
    return (
        f"Standard errors from {repeats} fits to simulated records of the same runs\n"
        + fit_report(bootstrap.fit)
    )


def trajectory_report(fit: TrajectoryFit) -> str:
    """Report a trajectory fit: statistics, and parameters with standard errors."""
    facts = [
        ("samples", str(fit.nobs)),
        ("sum of squares", f"{number(fit.sum_of_squares)} (of friction coefficients)"),
        ("simulations", str(fit.evaluations)),
        ("search", "converged" if fit.converged else f"not converged: {fit.message}"),
    ]
    lines = ["[[Fit]]", *columns([(k, f"= {v}") for k, v in facts], "<<", 4)]
    return "\n".join([*lines, "[[Parameters]]", *parameter_lines("journal", (), fit.parameters)])
