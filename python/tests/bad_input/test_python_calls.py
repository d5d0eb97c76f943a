"""What may be passed to the public functions: one clear error, or the numbers that it means."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from bad_input.checking import HEADER, RIG, RMS_N, ROWS, one_line
from jbf import Bearing, Drive, Load, Lubricant, Model, ParameterValue, Rig, Run

T, V, F = np.array(ROWS, dtype=float).T
N = len(T)
RUN = Run.from_arrays(T, V, F, name="a")
MODEL = Model(Rig(), "coulomb", parameters={"F_c_n": 5.0, "F_v_n_s_m": 20.0})
ANY: Any = None


def masked(values: Any, at: int = 3) -> Any:
    return np.ma.masked_array(values, mask=np.arange(N) == at)


def with_one(values: Any, at: int, value: Any, dtype: Any = float) -> Any:
    found = np.array(values, dtype=dtype)
    found[at] = value
    return found


COLUMNS: dict[str, tuple[Any, str]] = {
    "None in a list": ([None, *F[1:]], "friction_n"),
    "nan": (with_one(F, 3, np.nan), "sample 3: nan is not a finite number"),
    "inf": (with_one(F, 3, np.inf), "sample 3: inf is not a finite number"),
    "minus inf": (with_one(F, 3, -np.inf), "sample 3: -inf is not a finite number"),
    "1e160": (with_one(F, 3, 1e160), "sample 3: 1e+160 is beyond what any machine does"),
    "1e308": (with_one(F, 3, 1e308), "sample 3: 1e+308 is beyond what any machine does"),
    "masked": (masked(F), "column friction_n: has masked samples; leave them out"),
    "masked in a list": (list(masked(F)), "friction_n"),
    "text": (["a"] * N, "holds <U1, not numbers"),
    "numbers as text": ([str(f) for f in F], "not numbers"),
    "numbers as bytes": ([str(f).encode() for f in F], "not numbers"),
    "numbers as text objects": (np.array([str(f) for f in F], dtype=object), "friction_n"),
    "one text among numbers": ([*F[:-1].tolist(), "5.0"], "friction_n"),
    "one text object": (with_one(F, 3, "5.0", object), "friction_n"),
    "objects": ([object()] * N, "is not an array of numbers"),
    "dicts": ([{}] * N, "is not an array of numbers"),
    "complex": (F + 1j, "holds complex128, not numbers"),
    "complex objects": (with_one(F, 3, 1j, object), "friction_n"),
    "dates": (np.arange(N).astype("datetime64[s]"), "holds datetime64[s], not numbers"),
    "durations": (np.arange(N).astype("timedelta64[s]"), "holds timedelta64[s], not numbers"),
    "records": (np.zeros(N, dtype=[("a", float)]), "not numbers"),
    "two columns": (np.stack([F, F]), f"has shape (2, {N})"),
    "a column": (F[:, None], f"has shape ({N}, 1)"),
    "a scalar": (5.0, "has shape ()"),
    "ragged": ([[1.0], [1.0, 2.0]], "is not an array of numbers"),
    "empty": ([], f"has 0 samples where time_s has {N}"),
    "short": (F[:-1], f"has {N - 1} samples where time_s has {N}"),
    "long": (np.append(F, 1.0), f"has {N + 1} samples where time_s has {N}"),
    "one": ([5.0], f"has 1 sample where time_s has {N}"),
    "a path": ("a.csv", "not numbers"),
    "a run": (RUN, "friction_n"),
    "a function": (np.sin, "is not an array of numbers"),
    "a generator": ((f for f in F), "is not an array of numbers"),
    "a set": (set(F.tolist()), "is not an array of numbers"),
    "a dict": ({"a": 1.0}, "is not an array of numbers"),
    "huge integers": ([10**400] * N, "is not an array of numbers"),
}

MEANT: dict[str, Any] = {
    "float64": F,
    "float32": F.astype(np.float32),
    "longdouble": F.astype(np.longdouble),
    "big-endian": F.astype(">f8"),
    "a list": F.tolist(),
    "a tuple": tuple(F.tolist()),
    "objects that are numbers": np.array(F.tolist(), dtype=object),
    "every second": np.repeat(F, 2)[::2],
    "backwards twice": F[::-1].copy()[::-1],
    "a column of a table": np.asfortranarray(np.stack([T, F], 1))[:, 1],
    "masked nowhere": np.ma.masked_array(F, mask=False),
    "a view of memory": memoryview(F),
}

CALLS: dict[str, tuple[Callable[[], Any], str]] = {
    "no time": (lambda: Run.from_arrays(ANY, V, F), "time_s"),
    "no motion": (lambda: Run.from_arrays(T, friction_n=F), "no position tells the motion"),
    "time backwards": (lambda: Run.from_arrays(T[::-1], V, F), "sample 1: time runs back"),
    "time masked": (lambda: Run.from_arrays(masked(T), V, F), "time_s: has masked samples"),
    "speed masked": (lambda: Run.from_arrays(T, masked(V), F), "velocity_m_s: has masked"),
    "load masked": (lambda: Run.from_arrays(T, V, F, load_n=masked(F)), "load_n: has masked"),
    "extra masked": (lambda: Run.from_arrays(T, V, F, extra={"i": masked(F)}), "i: has masked"),
    "tiny steps": (lambda: Run.from_arrays(1e-320 * T, V, F), "time_s: "),
    "empty": (lambda: Run.from_arrays([], [], []), "has 0 samples; a run needs at least 10"),
    "select numbers": (lambda: RUN.select([1, 2]), "cannot select; give a slice"),
    "select masked": (lambda: RUN.select(masked(V > 0.1)), "cannot select"),
    "select backwards": (lambda: RUN.select(slice(None, None, -1)), "cannot run backwards"),
    "constructed of nan": (lambda: jbf.compare(MODEL, [Run("a", T, V * np.nan, F)]), "a"),
    "constructed of lists": (lambda: jbf.compare(MODEL, [Run("a", list(T), V, F)]), "a"),  # type: ignore[arg-type]
    "constructed of float32": (
        lambda: jbf.compare(MODEL, [Run("a", T.astype("f4"), V, F)]),  # type: ignore[arg-type]
        "a",
    ),
    "constructed uneven": (lambda: jbf.compare(MODEL, [Run("a", T, V[:-1], F)]), "a"),
    "compare an empty selection": (
        lambda: jbf.compare(MODEL, [RUN.select(slice(0, 0))]),
        "a: has 0 samples",
    ),
    "compare one sample": (
        lambda: jbf.compare(MODEL, [RUN.select(slice(0, 1))]),
        "a: has 1 sample",
    ),
    "fit one sample": (
        lambda: jbf.fit(Rig(), [RUN.select(slice(0, 1))], law="coulomb"),
        "a: has 1 sample",
    ),
    "diagnose an empty selection": (
        lambda: jbf.diagnose(Rig(), [RUN.select(slice(0, 0))], law="coulomb"),
        "a: has 0 samples",
    ),
    "compare none": (lambda: jbf.compare(MODEL, []), "no run"),
    "compare a run": (lambda: jbf.compare(MODEL, ANY or RUN), "runs is a single run"),
    "compare a path": (lambda: jbf.compare(MODEL, ANY or "a.csv"), "jbf.read_runs"),
    "compare arrays": (lambda: jbf.compare(MODEL, ANY or [T]), "runs holds a ndarray at place 0"),
    "compare with a rig": (lambda: jbf.compare(ANY or Rig(), [RUN]), "the model is a Rig"),
    "fit a path": (lambda: jbf.fit(ANY or "rig.toml", [RUN]), 'jbf.read_rig("rig.toml")'),
    "fit None": (lambda: jbf.fit(ANY, [RUN]), "the rig is None; give a jbf.Rig"),
    "fit runs None": (lambda: jbf.fit(Rig(), ANY, law="coulomb"), "runs is None"),
    "diagnose None": (lambda: jbf.diagnose(ANY, [RUN]), "the rig is None"),
    "predict None": (lambda: MODEL.predict(ANY), "the run is None"),
    "a model of None": (lambda: Model(ANY), "the rig is None"),
    "a value nan": (lambda: Model(Rig(), "coulomb", parameters={"F_c_n": np.nan}), "F_c_n"),
    "a value below": (lambda: Model(Rig(), "coulomb", parameters={"F_c_n": -1.0}), "F_c_n"),
    "a value masked": (
        lambda: Model(Rig(), "coulomb", parameters={"F_c_n": ANY or np.ma.masked}),
        "F_c_n",
    ),
    "a value an array": (lambda: ParameterValue(ANY or np.ones(2)), "key value: a ndarray is not"),
    "a radius as text": (lambda: Bearing(ANY or "1", 1.0, 0.1, 1.0, 4), "key radius_m: "),
    "a count of 2^32": (lambda: Bearing(1.0, 1.0, 0.1, 1.0, 2**32), "key count: 4294967296"),
    "a count of numpy": (lambda: Bearing(1.0, 1.0, 0.1, 1.0, ANY or np.float64(4)), "key count: "),
    "a load of nan": (lambda: Load(np.nan), "key normal_n: nan is not above zero"),
    "a viscosity of inf": (lambda: Lubricant(np.inf), "key viscosity_pa_s: inf is not"),
    "a drive of a word": (lambda: Drive(ANY or "spin", "force"), "key motion: "),
    "a rig of a path": (lambda: Rig(ANY or "rig.toml"), "the bearing is no jbf.Bearing but of str"),
    "a rig of a load": (lambda: Rig(load=ANY or 104.0), "the load is no jbf.Load but of float"),
    "load a model of None": (lambda: Model.load(ANY), "None is not a path"),
    "read a number": (lambda: jbf.read_run(ANY or 3), "int is not a path"),
    "import None": (lambda: jbf.import_files(ANY), "None is not a path"),
    "look at None": (lambda: jbf.look(ANY), "None is not a path"),
}


@pytest.mark.parametrize("name", COLUMNS)
def test_a_column_that_is_none(name: str) -> None:
    values, fragment = COLUMNS[name]
    one_line(lambda: Run.from_arrays(T, V, values, name="a"), fragment)


@pytest.mark.parametrize("name", MEANT)
def test_the_same_numbers_in_another_form(name: str) -> None:
    run = Run.from_arrays(T, V, MEANT[name])
    assert run.friction_n is not None
    assert run.friction_n.dtype == np.float64
    assert run.friction_n.flags.c_contiguous
    assert not run.friction_n.flags.writeable
    assert jbf.compare(MODEL, [run]).rms_n == pytest.approx(RMS_N, rel=5e-3)


@pytest.mark.parametrize("name", CALLS)
def test_a_wrong_call_is_one_line(name: str) -> None:
    call, fragment = CALLS[name]
    one_line(call, fragment)


def test_what_is_passed_is_copied_and_stays_as_it_was() -> None:
    mine = F.copy()
    run = Run.from_arrays(T, V, mine)
    mine[:] = 0.0
    assert run.friction_n is not None
    assert run.friction_n.tolist() == F.tolist()
    frozen = F.copy()
    frozen.flags.writeable = False
    assert Run.from_arrays(T, V, frozen).columns().keys() == set(HEADER)


def test_the_rig_of_the_tables_is_a_rig() -> None:
    Path("again.toml").write_text(RIG)
    assert jbf.read_rig("again.toml").bearing == Bearing(0.0127, 0.0254, 2.5e-5, 2.27, 4)
