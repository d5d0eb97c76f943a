"""The bench, its schemes and settings as the core takes them: every number in its place."""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jbf import InputError, Model, Rig
from jbf.control.bench import (
    ELASTIC,
    FITTED,
    THESIS_BENCH,
    THESIS_LOAD_N,
    THESIS_RIG,
    VOLTS_PER_N_M,
    Bench,
    core_model,
    thesis_model,
    with_noise,
)
from jbf.control.constants import COUNTS_PER_RAD, OBSERVER_1_S, TABLE_ENTRIES
from jbf.control.loop import core_loop, gains
from jbf.control.schemes import SCHEMES, scheme
from jbf.control.schemes.carried import Observed, Table
from jbf.control.schemes.learning import LISTED_VOLTS, Learning
from jbf.control.schemes.plain import Coulomb, NoCompensation, Repetitive
from jbf.control.settings import Settings
from jbf.control.task import TASKS

POSITION, VELOCITY = TASKS["position sine"], TASKS["velocity sine"]
SETTINGS = Settings(60.0, 2.0, 0.7, 1.7, 0.1, 30.0, 1.0, 1.9, 0.1)
NEWTONS = Model(Rig(), "coulomb", parameters={"F_c_n": 5.0, "F_v_n_s_m": 20.0})


def test_the_thesiss_bench() -> None:
    """a, b and the counter of chapter 6; steps of 2 ms, two of the plant in each."""
    assert (THESIS_BENCH.damping_1_s, THESIS_BENCH.input_rad_s2_v) == (135.0, 457.0)
    assert (THESIS_BENCH.dt_s, THESIS_BENCH.inner_steps) == (0.002, 2)
    assert (THESIS_BENCH.input_noise_v, THESIS_BENCH.encoder_noise_counts) == (0.005, 0.0)
    assert (THESIS_BENCH.seed, THESIS_BENCH.stood_s) == (1, 60.0)
    assert pytest.approx(104.0) == THESIS_LOAD_N
    # 25.5 V of inches and pounds, 2.89 V of metres and newtons.
    assert pytest.approx(25.5, abs=0.1) == LISTED_VOLTS
    metres_and_newtons = 4.0 * 0.0127 * 104.0 * VOLTS_PER_N_M
    assert metres_and_newtons == pytest.approx(2.89, abs=0.01)
    with pytest.raises(AttributeError):
        THESIS_BENCH.seed = 2  # type: ignore[misc]


POSITIVE = ("damping_1_s", "input_rad_s2_v", "volts_per_n", "limit_v", "counts_per_rad", "dt_s",
            "inner_steps")  # fmt: skip


@pytest.mark.parametrize("name", POSITIVE)
def test_what_must_be_above_zero(name: str) -> None:
    """Neither zero nor infinite nor no number."""
    for wrong in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(InputError, match=f"{name}: {wrong} is not above zero and finite"):
            replace(THESIS_BENCH, **{name: wrong})  # type: ignore[arg-type]
    assert getattr(replace(THESIS_BENCH, **{name: 1e-9}), name) == 1e-9  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["input_noise_v", "encoder_noise_counts", "stood_s"])
def test_what_may_be_zero(name: str) -> None:
    """Not below it."""
    assert getattr(replace(THESIS_BENCH, **{name: 0.0}), name) == 0.0  # type: ignore[arg-type]
    for wrong in (-1e-12, math.inf, math.nan):
        with pytest.raises(InputError, match=f"{name}: {wrong} is not zero or above, and finite"):
            replace(THESIS_BENCH, **{name: wrong})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "good", "bad", "rule"),
    [
        ("seed", (0, 1, 2**64 - 1), (-1, 2**64), r"between 0 and 2\^64 - 1"),
        ("counter_bits", (8, 32), (7, 33), "between 8 and 32"),
    ],
)
def test_whole_numbers_of_a_bench(
    name: str, good: tuple[int, ...], bad: tuple[int, ...], rule: str
) -> None:
    """Both ends belong to the range."""
    for value in good:
        assert getattr(replace(THESIS_BENCH, **{name: value}), name) == value
    for value in bad:
        with pytest.raises(InputError, match=rule):
            replace(THESIS_BENCH, **{name: value})


def test_a_model_as_the_core_takes_it() -> None:
    """Parameters of the law apart from those of each effect, in their order; no bearing is None."""
    model = thesis_model()
    told = core_model(model)
    assert (told["law"], told["clock"], told["load_n"]) == ("journal", "thesis", THESIS_LOAD_N)
    assert told["parameters"] == [0.26, FITTED["U_tr_m_s"], FITTED["K0"], FITTED["gamma"]]
    assert told["effects"] == [("drive_compliance", [40.0, 0.5, 1.8e-4])]
    assert told["bearing"] is not None
    worn = {"F_c_n": 5.0, "F_s_n": 6.0, "F_v_n_s_m": 20.0, "wear_in.a": 0.5, "wear_in.s_0_m": 0.2}
    plain = core_model(Model(Rig(), "coulomb", ["wear_in"], worn))
    assert plain == {
        "law": "coulomb",
        "bearing": None,
        "load_n": 1.0,
        "clock": plain["clock"],
        "parameters": [5.0, 6.0, 20.0],
        "effects": [("wear_in", [0.5, 0.2])],
    }
    whole = THESIS_BENCH.core(model)
    assert whole["model"] == told
    assert whole["drive"] == THESIS_BENCH.drive()
    assert set(THESIS_BENCH.drive()) == {"damping_1_s", "input_rad_s2_v", "volts_per_n", "limit_v"}
    names = set(asdict(THESIS_BENCH)) - set(THESIS_BENCH.drive()) - {"dt_s"}
    assert {n: whole[n] for n in names} == {n: getattr(THESIS_BENCH, n) for n in names}


@pytest.mark.parametrize(
    ("elastic", "effects"),
    [("belt", ("drive_compliance",)), ("contact", ("presliding",)), ("nothing", ())],
)
def test_what_gives_way_between_motor_and_sliding(elastic: str, effects: tuple[str, ...]) -> None:
    """Belt, contact or nothing; values in the place of the fitted ones, and the film's clock."""
    model = thesis_model(elastic=elastic, clock="journal", K0=1e6)
    assert (model.effects, model.clock, model.rig) == (effects, "journal", THESIS_RIG)
    values = {n: p.value for n, p in model.parameters.items()}
    assert values == {"f_m": 0.26, **FITTED, "K0": 1e6, **ELASTIC[elastic]}
    # The shaft turns by one count before it slides: K0 over it is 0.26 a count's way.
    bend = ELASTIC["contact"]["presliding.sigma_1_m"]
    assert bend * 0.0127 / COUNTS_PER_RAD == pytest.approx(0.26)


@pytest.mark.parametrize("times", [1.0, 2.0, 4.0, 0.5])
@pytest.mark.parametrize("counts", [0.0, 0.7])
def test_noise_times_so_much_counts_the_encoders_steps(times: float, counts: float) -> None:
    """Counting is noise of a twelfth of a square count; less than that no encoder has."""
    bench = with_noise(replace(THESIS_BENCH, encoder_noise_counts=counts), times)
    assert bench.input_noise_v == pytest.approx(0.005 * times)
    wanted = max(times**2 * (counts**2 + 1.0 / 12.0) - 1.0 / 12.0, 0.0)
    assert bench.encoder_noise_counts**2 == pytest.approx(wanted, abs=1e-15)


def test_what_stands_round_a_compensator() -> None:
    """Step, control law, drive and encoder; limits of a guard, or none."""
    guarded = core_loop(POSITION, THESIS_BENCH, SETTINGS)
    assert guarded == {
        "dt_s": 0.002,
        "position": True,
        "drive": THESIS_BENCH.drive(),
        "counts_per_rad": COUNTS_PER_RAD,
        "counter_bits": THESIS_BENCH.counter_bits,
        "moving_v": 1.9,
        "patience_s": 0.1,
    }
    alone = core_loop(VELOCITY, THESIS_BENCH, None)
    assert (alone["position"], alone["moving_v"], alone["patience_s"]) == (False, None, None)


def test_schemes_by_their_names() -> None:
    """A model where they know one, settings where they have any; an unknown one is refused."""
    kinds = (NoCompensation, Learning, Coulomb, Table, Repetitive, Observed)
    made = [scheme(name) for name in SCHEMES]
    assert [type(s) for s in made] == list(kinds)
    assert tuple(s.name for s in made) == SCHEMES
    table: Any = scheme("table", NEWTONS)
    observed: Any = scheme("observed", NEWTONS, SETTINGS)
    assert table.model is observed.model is NEWTONS
    assert observed.settings is SETTINGS
    assert (made[3].model, made[5].model) == (thesis_model(), thesis_model())  # type: ignore[attr-defined]
    assert made[1] == Learning()
    learning: Any = scheme("learning", thesis_model())
    assert learning.k0 == FITTED["K0"]
    with pytest.raises(InputError, match='there is no scheme "non"; did you mean "none"'):
        scheme("non")


def test_plain_schemes_as_the_core_takes_them() -> None:
    """The thesis's numbers; nothing guards them."""
    assert NoCompensation().core(VELOCITY, THESIS_BENCH) == {"kind": "none"}
    assert Coulomb().core(VELOCITY, THESIS_BENCH) == {
        "kind": "coulomb", "gain": 0.01, "exponent": 1.0, "limit_v": 5.0, "start_v": 0.0
    }  # fmt: skip
    for plain in (NoCompensation(), Coulomb(), Learning(), Repetitive(), Table(NEWTONS)):
        assert plain.guard(THESIS_BENCH) is None


@pytest.mark.parametrize("name", ["position sine", "velocity sine"])
def test_learning_from_lap_to_lap(name: str) -> None:
    """Half of the loop's stiffness, a lead by the control law, unless they are given."""
    task = TASKS[name]
    core = Repetitive().core(task, THESIS_BENCH)
    g, c = gains(task, THESIS_BENCH)
    stuck = 1.0 + c * 457.0 / (135.0 + OBSERVER_1_S)
    wanted = 0.5 * (g / stuck if task.is_position else g + c)
    assert core == {
        "kind": "repetitive",
        "steps_per_lap": round(2.0 * math.pi / 0.25 / 0.002),
        "lap_gain": pytest.approx(wanted),
        "smooth": 0.1,
        "lead_s": 0.1 if task.is_position else 0.02,
        "limit_v": 3.0,
    }
    given = Repetitive(gain=0.0, lead_s=0.0).core(task, THESIS_BENCH)
    assert (given["lap_gain"], given["lead_s"]) == (0.0, 0.0)


def test_the_learning_scheme_as_the_core_takes_it() -> None:
    """The programs' numbers; the bench's scale unless one is given; bounds about a fitted model."""
    core = Learning().core(VELOCITY, THESIS_BENCH)
    assert core["volts"] == pytest.approx(THESIS_BENCH.volts_per_n * 104.0)
    known = {"kind": "learning", "load_n": 104.0, "clock": "thesis", "f_m": 0.26, "u_tr_m_s": 0.05,
             "k0": 650_000.0, "gamma": 33.0, "eps_tr": 0.9747, "k0_gain": None, "gamma_gain": None,
             "k0_bounds": (1.0, 1e8), "gamma_bounds": (1e-3, 1e4)}  # fmt: skip
    assert {n: core[n] for n in known} == known
    assert core["bearing"]["radius_m"] == pytest.approx(0.0127)
    assert Learning(volts=0.0).core(VELOCITY, THESIS_BENCH)["volts"] == 0.0
    made = Learning.of(thesis_model(clock="journal", gamma=50.0))
    assert (made.k0, made.gamma, made.u_tr_m_s) == (FITTED["K0"], 50.0, FITTED["U_tr_m_s"])
    assert (made.eps_tr, made.clock, made.f_m) == (None, "journal", 0.26)
    assert made.k0_bounds == pytest.approx((502.9, 5.029e8))
    assert made.gamma_bounds == pytest.approx((5e-3, 5e3))
    with pytest.raises(InputError, match="runs the journal's film, this is coulomb; choose"):
        Learning.of(NEWTONS)


@pytest.mark.parametrize(("task", "top"), [(VELOCITY, 1.04), (POSITION, 1.0)])
def test_a_table_holds_steady_friction_from_zero_at_rest(task: Any, top: float) -> None:
    """Of 5 N and 20 N s/m up to the largest speed, at least a radian a second."""
    core = Table(NEWTONS).core(task, THESIS_BENCH)
    width = top / (TABLE_ENTRIES - 1)
    speeds = width * np.arange(TABLE_ENTRIES)
    wanted = (5.0 + 20.0 * speeds) * THESIS_BENCH.volts_per_n
    assert (core["width"], core["by_angle"]) == (pytest.approx(width), False)
    assert (core["kind"], core["viscous_v_s"]) == ("table", 0.0)
    assert core["levels_v"][0] == 0.0
    assert core["levels_v"][1:] == pytest.approx(wanted[1:].tolist())
    # A bearing's speed is its journal's.
    model = thesis_model()
    slow, fast = (1e-9, top * 0.0127)
    levels = Table(model).core(task, THESIS_BENCH)["levels_v"]
    steady = model.steady_friction(np.array([slow, fast])) * THESIS_BENCH.volts_per_n
    assert levels[-1] == pytest.approx(float(steady[1]))


def test_the_observed_scheme_as_the_core_takes_it() -> None:
    """Its settings guard it; those that are not given are tuned to the bench."""
    made = Observed(thesis_model(), SETTINGS, start=(0.1, 0.2))
    assert made.guard(THESIS_BENCH) is SETTINGS
    assert made.core(VELOCITY, THESIS_BENCH) == {
        "kind": "observed",
        "model": core_model(thesis_model()),
        "settings": asdict(SETTINGS),
        "start": (0.1, 0.2),
    }
    tuned = Observed(thesis_model())
    coarse = replace(THESIS_BENCH, dt_s=0.004)
    assert tuned.core(VELOCITY, coarse)["settings"]["bandwidth_rad_s"] == pytest.approx(30.0)
    assert tuned.core(VELOCITY, coarse)["start"] == (0.0, 0.0)


@pytest.mark.parametrize("name", list(asdict(SETTINGS)))
def test_settings_are_zero_or_above(name: str) -> None:
    """And finite numbers."""
    assert getattr(replace(SETTINGS, **{name: 0.0}), name) == 0.0
    for wrong in (-1e-9, math.inf, math.nan):
        with pytest.raises(InputError, match=f"{name}: {wrong} is not zero or above, and finite"):
            replace(SETTINGS, **{name: wrong})


def test_settings_as_a_file(tmp_path: Path) -> None:
    """Six digits, each with what it means; a key that lacks or is none is named with the file."""
    path = tmp_path / "s.toml"
    replace(SETTINGS, level_limit_v=0.123456789).save(path)
    lines = path.read_text().splitlines()
    assert lines[0] == (
        "# jbf control settings, in SI units; `jbf control tune MODEL` computes them from a fitted "
        "model."
    )
    assert "level_limit_v = 0.123457 # most that the friction level may be corrected by" in lines
    assert Settings.load(path) == replace(SETTINGS, level_limit_v=0.123457)
    path.write_text("\n".join(line for line in lines if "patience" not in line))
    with pytest.raises(InputError, match=r"s\.toml.*patience_s: is missing; add it, or tune"):
        Settings.load(path)
    path.write_text("\n".join([*lines, "patients = 1.0"]))
    with pytest.raises(InputError, match=r"s\.toml.*patients.*did you mean"):
        Settings.load(path)


def test_a_bench_is_its_numbers() -> None:
    """Two of the same numbers are alike."""
    assert Bench() == THESIS_BENCH
    assert replace(THESIS_BENCH, seed=2) != THESIS_BENCH
