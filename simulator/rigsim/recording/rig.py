"""Artefacts outside the logger: a rig that varies from run to run, and a noisy load channel."""

from __future__ import annotations

from dataclasses import replace

from ..seeds import Rng
from .draft import Artefact, Draft, Sizes
from .ranges import sized


def _runs_differ(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    warm, thin = (1.0 + sizes["sd"] * rng.standard_normal(2)).tolist()
    base = draft.signals.base
    other = replace(base, U_tr=base.U_tr * warm, gamma=base.gamma * thin)
    draft.signals = replace(draft.signals, base=other)
    return {"U_tr": warm, "gamma": thin}


def _noisy_load(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    draft.load = draft.load * (1.0 + sizes["sd"] * rng.standard_normal(len(draft.load)))
    return dict(sizes)


RIG = (
    Artefact(
        "runs_differ",
        "rig",
        "rig",
        sized(sd=((0.015, 0.025), (0.05, 0.07), (0.1, 0.14))),
        _runs_differ,
    ),
)
LOAD = (
    Artefact(
        "noisy_load",
        "load",
        "load",
        sized(sd=((0.005, 0.01), (0.015, 0.025), (0.04, 0.06))),
        _noisy_load,
    ),
)
