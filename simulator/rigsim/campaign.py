"""Complete measurement campaigns: standard motions, a random rig, hidden effects and files."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from .bearing import Base, Bearing
from .catalogue import check, draw
from .foreign import Foreign, draw_foreign, parameters
from .motions import Motion, multisine, sine, steps, stop_and_go, sweep, triangle
from .noise import Noise
from .record import Record
from .seeds import stream
from .simulate import simulate_run
from .warmth import Kind, draw_warmth, read_by


@dataclass(frozen=True)
class Campaign:
    """Named list of motions, each of which is recorded as one run.

    `load_shares` contains the load of each run, by the name of its motion, as a multiple of the
    rig's load.
    """

    name: str
    motions: tuple[Motion, ...]
    load_shares: Mapping[str, float] = field(default_factory=dict)


def _one_way(name: str, duration_s: float, omega: float) -> Motion:
    return sine(name, duration_s, 0.0595, omega, bias=0.0728)


def standard(name: str) -> Campaign:
    """Return a standard campaign by its name.

    The names are `full`, `heldout`, `loads`, `one_way`, `short`, `slow` and `steady`.
    """
    shares: dict[str, float] = {}
    if name == "full":
        moves = [(1.0, 1), (9.1, -1), (26.2, 1), (32.1, 1), (61.2, -1), (72.3, -1), (78.9, 1)]
        motions = [
            sine("bi_w0.10", 126.0, 0.127, 0.1),
            sine("bi_w0.25", 76.0, 0.127, 0.25),
            sine("bi_w1.0", 32.0, 0.127, 1.0),
            sine("bi_w2.0", 25.2, 0.127, 2.0),
            _one_way("uni_w0.25", 76.0, 0.25),
            stop_and_go("stopgo", moves, 0.055, 0.8, 3.5, 88.0),
        ]
    elif name == "heldout":
        tones = [(0.055, 0.31, 0.4), (0.035, 0.83, 1.1), (0.025, 1.7, 2.6)]
        moves = [(1.2, 1), (11.2, 1), (33.2, 1), (40.2, 1), (54.2, 1)]
        motions = [
            sine("bi_w0.5", 51.0, 0.127, 0.5),
            triangle("tri_w0.3", 63.0, 0.12, 0.3),
            multisine("multi", 60.0, tones),
            stop_and_go("stopgo2", moves, 0.07, 1.0, 4.0, 66.0),
            _one_way("uni_w0.5", 38.0, 0.5),
        ]
    elif name == "one_way":
        # The motion never reverses: terms with and without the sign of the speed are confounded.
        motions = [_one_way("uni_w0.25", 50.3, 0.25), _one_way("uni_w1.0", 25.2, 1.0)]
    elif name == "short":
        motions = [
            sine("two_way_0.25", 50.3, 0.127, 0.25),
            sine("two_way_1", 25.2, 0.127, 1.0),
            sine("two_way_2", 18.9, 0.127, 2.0),
            sine("one_way_0.5", 25.2, 0.0595, 0.5, bias=0.0728),
            stop_and_go("stop_and_go", [(1.0, 1), (9.0, -1), (22.0, 1)], 0.055, 0.8, 3.5, 30.0),
        ]
    elif name == "slow":
        motions = [
            sweep("sweep", 0.1323, 240.0),
            sine("bi_w0.0225", 280.0, 0.127, 0.0225),
            sine("bi_w0.045", 140.0, 0.127, 0.045),
        ]
    elif name == "loads":
        motions = [
            sine("bi_w0.25_light", 51.0, 0.127, 0.25),
            sine("bi_w1.0_light", 26.0, 0.127, 1.0),
            sine("bi_w0.25", 51.0, 0.127, 0.25),
            sine("bi_w1.0", 26.0, 0.127, 1.0),
            sine("bi_w0.25_heavy", 51.0, 0.127, 0.25),
            stop_and_go("stopgo", [(1.0, 1), (9.0, -1), (22.0, 1)], 0.055, 0.8, 3.5, 30.0),
        ]
        shares = {"bi_w0.25_light": 0.7, "bi_w1.0_light": 0.7, "bi_w0.25_heavy": 1.35}
    elif name == "steady":
        speeds = [0.002, 0.005, 0.01, 0.02, 0.04, 0.08, 0.12]
        motions = [
            steps("steps_forward", speeds, 8.0),
            steps("steps_backward", [-v for v in speeds], 8.0),
        ]
    else:
        raise ValueError(
            f"no campaign named {name!r}; there are full, heldout, loads, one_way, short, slow, "
            "steady"
        )
    return Campaign(name, tuple(motions), shares)


def draw_base(seed: int) -> Base:
    """Draw a random rig with parameters around those of Tables 4.2 to 4.5 of Cohn (1998)."""
    rng = stream(seed, "base")
    return Base(
        f_m=float(rng.uniform(0.20, 0.29)),
        U_tr=float(rng.uniform(0.045, 0.065)),
        K0=float(rng.uniform(4e5, 9e5)),
        gamma=float(rng.uniform(26.0, 40.0)),
        load_n=float(rng.choice([104.0, 83.5])),
    )


def _choose(
    seed: int, effects: Iterable[str] | Mapping[str, dict[str, float]], strength: float
) -> dict[str, dict[str, float]]:
    if isinstance(effects, Mapping):
        return {name: dict(values) for name, values in effects.items()}
    return {name: draw(name, stream(seed, "effect", name), strength) for name in effects}


def simulate_campaign(
    seed: int,
    effects: Iterable[str] | Mapping[str, dict[str, float]] = (),
    strength: float = 1.0,
    noise: float | None = None,
    coloured: bool = False,
    campaign: str | Campaign = "full",
    foreign: Sequence[str] = (),
    temperature: Kind | None = None,
    thermometer: str = "fine",
) -> tuple[dict[str, Record], dict[str, Any]]:
    """Simulate the runs of a campaign, and return their records by name with the true values.

    `effects` are names (parameters are drawn at `strength`) or a mapping of names to parameters.
    `noise` is the standard deviation of white noise relative to the nominal peak f_m F, drawn from
    1 to 2.5 % if None. `coloured` adds noise of first order, half as large, with a time constant of
    0.2 s. Rig, effects and noise level depend on `seed` alone, so two campaigns with one seed
    describe the same rig. The temperature varies, and is recorded, if an effect requires this, or
    as specified by `temperature`.
    """
    plan = standard(campaign) if isinstance(campaign, str) else campaign
    base = draw_base(seed)
    chosen = _choose(seed, effects, strength)
    check(chosen)
    strange: list[Foreign] = [
        draw_foreign(name, stream(seed, "foreign", name), strength) for name in foreign
    ]
    share = noise if noise is not None else float(stream(seed, "noise").uniform(0.01, 0.025))
    meter = Noise(share * base.f_m * base.load_n, coloured_share=0.5 if coloured else 0.0)
    records: dict[str, Record] = {}
    weight: dict[str, float] = {}
    if temperature is None and "vogel_viscosity" in chosen:
        temperature = "wandering"
    for number, motion in enumerate(plan.motions):
        air = stream(seed, "temperature", motion.name)
        warmth = temperature and draw_warmth(temperature, number, motion.duration_s, air)
        rng = stream(seed, plan.name, motion.name)
        angle = float(rng.uniform(0.0, 2.0 * math.pi))
        load = base.load_n * plan.load_shares.get(motion.name, 1.0)
        record = simulate_run(
            base,
            chosen,
            motion,
            start_angle_rad=angle,
            load_n=load,
            foreign=strange,
            noise=meter,
            rng=rng,
            warmth=warmth or None,
        )
        if record.temperature_c is not None:
            celsius = read_by(thermometer, record.time_s, record.temperature_c, air)
            record = replace(record, temperature_c=celsius)
        records[motion.name] = record
        if meter.friction_n > 0.0:
            bare = simulate_run(base, {}, motion, load_n=load) if chosen or strange else record
            gap = record.clean_friction_n - bare.clean_friction_n
            weight[motion.name] = float(np.sqrt(np.mean(gap**2))) / meter.friction_n
    rig = {k: v for k, v in asdict(base).items() if k != "bearing"}
    truth = {
        "effects": chosen,
        "foreign": {f.name: parameters(f) for f in strange},
        "base": rig,
        "noise_n": meter.friction_n,
        "coloured": coloured,
        "seed": seed,
        "strength": strength,
        "campaign": plan.name,
        "effect_to_noise": weight,
    }
    return records, truth


def rig_toml(bearing: Bearing, load_n: float) -> str:
    """Return the contents of `rig.toml` for a bearing and a load (N)."""
    return (
        f"[bearing]\nradius_m = {bearing.radius_m}\nlength_m = {bearing.length_m}\n"
        f"clearance_m = {bearing.clearance_m}\nmass_kg = {bearing.mass_kg}\n"
        f"count = {bearing.count}\n\n[lubricant]\nviscosity_pa_s = {bearing.viscosity_pa_s}\n\n"
        f"[load]\nnormal_n = {load_n}\n"
    )


def write_campaign(
    folder: str | Path,
    seed: int,
    effects: Iterable[str] | Mapping[str, dict[str, float]] = (),
    strength: float = 1.0,
    noise: float | None = None,
    coloured: bool = False,
    campaign: str | Campaign = "full",
    foreign: Sequence[str] = (),
) -> dict[str, Any]:
    """Simulate a campaign, write rig.toml and one CSV per run, and return the true values.

    The arguments are those of `simulate_campaign`.
    """
    records, truth = simulate_campaign(seed, effects, strength, noise, coloured, campaign, foreign)
    out = Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    (out / "rig.toml").write_text(rig_toml(Bearing(), truth["base"]["load_n"]), encoding="utf-8")
    for name, record in records.items():
        record.write(out / f"{name}.csv")
    return truth
