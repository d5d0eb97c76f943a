"""Units against their definitions, and column expressions against the arithmetic of Python."""

import math
import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from jbf.errors import InputError
from jbf.importing.evaluation import converted, evaluate
from jbf.importing.expression import parse_expression, references, written
from jbf.importing.targets import wanted_unit
from jbf.units.unit import ONE, parse_unit, unit_of_name

# Definitions: SI brochure; international pound, inch and standard gravity.
SIZES = {
    "kN": 1e3, "lbf": 4.4482216152605, "kgf": 9.80665, "kp": 9.80665, "mm": 1e-3, "µm": 1e-6,
    "in": 0.0254, "rpm": 2 * math.pi / 60, "U/min": 2 * math.pi / 60, "1/min": 2 * math.pi / 60,
    "deg": math.pi / 180, "°/s": math.pi / 180, "rev": 2 * math.pi, "bar": 1e5,
    "psi": 6894.757293168, "N/mm^2": 1e6, "MPa": 1e6, "Nm": 1.0, "N·m": 1.0, "N-m": 1.0,
    "Ncm": 0.01, "lbf in": 0.112984829,
    "mm/s": 1e-3, "m/min": 1 / 60, "km/h": 1 / 3.6, "%": 0.01, "ms": 1e-3, "min": 60.0,
    "kg m²": 1.0, "N/(mm s)": 1e3, "m s^-2": 1.0, "mA": 1e-3, "gon": math.pi / 200,
}  # fmt: skip


@pytest.mark.parametrize("text", SIZES)
def test_size_of_a_parsed_unit_agrees_with_its_definition(text: str) -> None:
    assert parse_unit(text).in_si == pytest.approx(SIZES[text], rel=1e-9)


NO_UNITS = ["", "foo", "N//m", "m^", "(m", "m)", "N m ^2 x", "Kanal", "#", "1/"]


@pytest.mark.parametrize("text", NO_UNITS)
def test_parsing_text_that_is_not_a_unit_returns_none(text: str) -> None:
    assert parse_unit(text) is None


@pytest.mark.parametrize(
    ("value", "unit", "target", "expected"),
    [
        (32.0, "°F", "°C", pytest.approx(0.0)),
        (212.0, "°F", "°C", pytest.approx(100.0)),
        (293.15, "K", "°C", pytest.approx(20.0)),
        # A conversion to the same unit preserves all bits.
        (22.5, "°C", "°C", 22.5),
        (math.pi / 30, "rad/s", "rpm", pytest.approx(1.0)),
        (90.0, "deg", "rev", pytest.approx(0.25)),
        (180.0, "deg", "rad", pytest.approx(math.pi)),
        (36.0, "km/h", "m/s", pytest.approx(10.0)),
    ],
)
def test_temperatures_angles_and_speeds_are_converted_between_units(
    value: float, unit: str, target: str, expected: Any
) -> None:
    result = parse_unit(unit).converted(np.array([value]), parse_unit(target))
    assert result.tolist() == [expected]


@given(st.integers(0, 10**9))
def test_milliseconds_convert_to_the_nearest_double(count: int) -> None:
    seconds = parse_unit("ms").converted(np.array([float(count)]), parse_unit("s"))[0]
    assert seconds == float(Fraction(count, 1000))


def test_unit_is_read_from_the_suffix_of_a_column_name() -> None:
    assert unit_of_name("torque_n_m") == ("torque", parse_unit("N m"))
    assert unit_of_name("speed") is None


# Expressions.
NAMES = ["F", "F2", "Torque [Nm]", "Kraft / kN", "a-b", "t(ms)", "Weg  links", "sin"]
MEANT = {name: name for name in NAMES} | {"Torque": "Torque [Nm]"}
UNITS = {"Torque [Nm]": "Nm", "Kraft / kN": "kN", "t(ms)": "ms"}
VALUES = {name: np.array([i + 1.5, -2.0 * i - 1.0]) for i, name in enumerate(NAMES)}


def value(text: str, key: str) -> np.ndarray:
    return converted(evaluate(parse_expression(text, MEANT), VALUES, UNITS), wanted_unit(key), key)


# The function `sin` is excluded, because it is the name of a column here.
FUNCTIONS = ["abs", "sign", "sqrt", "cos"]
BARE = {name: name for name in NAMES if name != "sin"}


def trees() -> st.SearchStrategy[tuple[str, str]]:
    """A column expression and the equivalent Python expression."""
    leaf = st.one_of(
        st.sampled_from(NAMES).map(lambda n: (written(n), f"v[{n!r}]")),
        # NumPy numbers, for which division by zero is defined.
        st.floats(0.01, 1e3).map(lambda x: (repr(x), f"float64({x!r})")),
    )

    def grow(inner: st.SearchStrategy[tuple[str, str]]) -> st.SearchStrategy[tuple[str, str]]:
        pair = st.tuples(inner, st.sampled_from("+-*/"), inner)
        return st.one_of(
            pair.map(lambda p: (f"({p[0][0]} {p[1]} {p[2][0]})", f"({p[0][1]} {p[1]} {p[2][1]})")),
            inner.map(lambda p: (f"-{p[0]}", f"(-{p[1]})")),
            st.tuples(st.sampled_from(FUNCTIONS), inner).map(
                lambda p: (f"{p[0]}({p[1][0]})", f"{p[0]}({p[1][1]})")
            ),
        )

    return st.recursive(leaf, grow, max_leaves=8)


@settings(deadline=None)
@given(trees())
@example(("-(1.0 / (1.0 - 1.0))", "(-(float64(1.0) / (float64(1.0) - float64(1.0))))"))
def test_random_expression_has_the_values_that_python_computes(tree: tuple[str, str]) -> None:
    ours, python = tree
    result = evaluate(parse_expression(ours, MEANT), VALUES, dict.fromkeys(NAMES, ""))
    with np.errstate(all="ignore"):
        functions = {name: getattr(np, name) for name in FUNCTIONS}
        wanted = eval(python, {"v": VALUES, "float64": np.float64, **functions})
    np.testing.assert_array_equal(np.asarray(result.value), wanted)


@pytest.mark.parametrize(
    ("text", "unit", "known"),
    [
        ("sin(30 [deg])", "", 0.5),
        ("cos(60 [deg])", "", 0.5),
        ("sin(0.25 [rev])", "", 1.0),
        ("sqrt(4 [mm] / 1 [m])", "", np.sqrt(0.004)),
        ("sign(-3 [kN])", "", -1.0),
        ("abs(-3 [kN])", "N", 3000.0),
        ("2 [kN] * sign(0.1 [mm])", "N", 2000.0),
    ],
)
def test_expression_functions_convert_argument_units(text: str, unit: str, known: float) -> None:
    result = evaluate(parse_expression(text, BARE), VALUES, UNITS)
    assert float(converted(result, parse_unit(unit) or ONE, "x")) == pytest.approx(known)


@pytest.mark.parametrize(
    ("text", "fragment"),
    [
        ("sin(3 [N])", "sin requires an angle, not N"),
        ("cos(2 [rad] * 1 [rad])", "requires an angle"),
        ("sqrt(4 [N])", "the square root of N has no unit"),
        ("abs(20 [C])", "has an offset zero"),
    ],
)
def test_expression_functions_refuse_arguments_with_wrong_units(text: str, fragment: str) -> None:
    with pytest.raises(InputError, match=fragment):
        evaluate(parse_expression(text, BARE), VALUES, UNITS)


@pytest.mark.parametrize("key", ["angle_rad", "velocity_rad_s", "friction_n"])
def test_column_without_a_unit_is_refused_with_the_key(key: str) -> None:
    with pytest.raises(InputError, match="has no unit") as caught:
        value("F", key)
    assert caught.value.key == f"columns.{key}"


@given(st.text(max_size=40))
@settings(deadline=None, max_examples=40)
def test_arbitrary_text_is_parsed_as_an_expression_or_refused_in_one_line(text: str) -> None:
    refusal = ""
    try:
        columns = {reference.column for reference in references(parse_expression(text, MEANT))}
    except InputError as error:
        columns, refusal = set(), str(error)
    assert columns <= set(NAMES)
    assert "\n" not in refusal


F, LEFT = VALUES["F"], VALUES["Weg  links"]
TURN = 2.0 * math.pi
CONVERTED = {
    ("Torque [Nm] / 0.5 [m]", "friction_n"): [7.0, -10.0],
    ("Torque / 0.5", "friction_n"): [7.0, -10.0],
    ("Kraft / kN", "friction_n"): [4500.0, -7000.0],
    ("Torque [Ncm]", "torque_n_m"): pytest.approx([0.035, -0.05]),
    ("a-b [mm]", "position_m"): pytest.approx([0.0055, -0.009]),
    ("F2 [N] - F [N]", "friction_n"): [1.0, -2.0],
    ("`Weg  links` [rpm] * 10 [mm]", "velocity_m_s"): pytest.approx(LEFT * TURN / 60 * 0.01),
    ("F [counts] / 4096 [counts/rev]", "angle_rad"): pytest.approx(F / 4096 * TURN),
    ("F [mm] / 5 [mm/rev]", "angle_rad"): pytest.approx(F / 5 * TURN),
    ("F [rev] * 5 [mm/rev]", "position_m"): pytest.approx(F * 5e-3),
    ("F [bar] * 314 [mm^2]", "friction_n"): pytest.approx(F * 31.4),
    ("F [%] * 2 [N m]", "torque_n_m"): pytest.approx(F * 0.02),
}


@pytest.mark.parametrize(("text", "key"), CONVERTED)
def test_expression_of_columns_is_converted_to_the_unit_of_its_target(text: str, key: str) -> None:
    assert value(text, key).tolist() == CONVERTED[text, key]


REFUSED = {
    ("F", "friction_n"): "but N is required",
    ("F [mm]", "friction_n"): "but N is required",
    ("F [counts] / 4096", "angle_rad"): "revolutions, degrees or radians",
    ("F [mm] / 5 [mm]", "angle_rad"): "revolutions, degrees or radians",
    ("Kraft / kN * 1000", "friction_n"): "a second time",
    ("t(ms) / 1000", "time_s"): "a second time",
    ("t(ms) * 0.001", "time_s"): "a second time",
    ("F [bar] + F2 [mm]", "friction_n"): "cannot be added",
    ("F [kg]", "friction_n"): "but N is required",
    ("F [?]", "friction_n"): "its unit is open",
    ("F [foo]", "friction_n"): "is not known",
    ("F [°C] * 2", "temperature_c"): "an offset zero",
    ("G", "friction_n"): 'no column "G"',
    ("F +", "friction_n"): "ends where",
    ("(F", "friction_n"): "not closed",
    ("__import__('os')", "friction_n"): "no column",
}


@pytest.mark.parametrize(("text", "key"), REFUSED)
def test_expression_with_a_wrong_unit_column_or_syntax_is_refused(text: str, key: str) -> None:
    with pytest.raises(InputError, match=re.escape(REFUSED[text, key])):
        value(text, key)


@pytest.mark.parametrize("key", ["fricton_n", "position_mm", "velocity_ms", "torque_nm"])
def test_misspelt_target_column_is_refused_with_a_suggestion(key: str) -> None:
    with pytest.raises(InputError, match="did you mean"):
        wanted_unit(key)
