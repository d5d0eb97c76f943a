"""Inference of unit and quantity from the column headers of instruments."""

import pytest
from jbf.importing.columns import parse_header

UNITS = {
    "time": {
        "time_s": "s", "Zeit": "", "t[ms]": "ms", "Elapsed Time (sec)": "sec", "time_ms": "ms",
    },
    "force": {
        "Kraft [N]": "N", "Kraft in kN": "kN", "Force / kN": "kN", "Reibkraft [N]": "N",
        "friction_n": "N", "Load cell [N]": "N",
    },
    "load": {"Normalkraft [N]": "N", "Normal Force (N)": "N", "Load [kg]": "kg"},
    "place": {
        "Weg [mm]": "mm", "Déplacement (mm)": "mm", "ActPos_mm": "mm", "x": "",
        "Drehwinkel [°]": "°", "Encoder [counts]": "counts", "pos (in)": "in",
    },
    "speed": {
        "Geschwindigkeit mm/s": "mm/s", "speed_rpm": "rpm", "Drehzahl [U/min]": "U/min",
        "n [min-1]": "min-1", "omega (rad/s)": "rad/s", "Vitesse de rotation (tr/min)": "tr/min",
        "motor_velocity_rad_s": "rad/s",
    },
    "torque": {
        "Torque, Nm": "Nm", "Torque [N-m]": "N-m", "Couple [N.m]": "N.m", "torque_pct": "%",
        "tau {mNm}": "mNm",
    },
    "current": {"Strom [A]": "A", "Iq (mA)": "mA", "motor current <A>": "A"},
    "temperature": {"Temperatur Öl [°C]": "°C", "Oil Temperature (°F)": "°F"},
    "pressure": {"pressure_pa": "Pa", "Hydraulikdruck / MPa": "MPa"},
    "voltage": {"Spannung [V]": "V"},
    "coefficient": {"coefficient of friction": "", "Reibwert µ": ""},
    "index": {"Sample #": ""},
    "run": {"Versuch": ""},
    None: {"Kanal 7": "", "Status": ""},
}  # fmt: skip
"""Units by quantity and header."""


@pytest.mark.parametrize("kind", UNITS)
def test_unit_and_quantity_are_read_from_a_header(kind: str | None) -> None:
    for header, unit in UNITS[kind].items():
        result = parse_header(header)
        assert (result.unit, result.kind) == (unit, kind), header


@pytest.mark.parametrize(
    ("setpoint", "measurement"),
    [
        ("setpoint_rpm", "speed_rpm"),
        ("Soll-Drehzahl [1/min]", "Ist-Drehzahl [1/min]"),
        ("pos_ref_mm", "pos_mm"),
        ("Consigne (N)", "Force (N)"),
        ("Target Speed (rpm)", "Actual Speed (rpm)"),
    ],
)
def test_header_is_recognised_as_set_point_or_measurement(setpoint: str, measurement: str) -> None:
    assert parse_header(setpoint).setpoint
    assert not parse_header(measurement).setpoint


def test_headers_f_and_t_are_read_as_force_and_time_whatever_their_unit() -> None:
    assert parse_header("F_N [N]").kind == "force"
    assert parse_header("T [°C]").kind == "time"  # rejected later because of its unit


def test_speed_of_a_motor_is_distinguished_from_other_speeds_by_its_header() -> None:
    assert parse_header("Motor Speed [rpm]").motor
    assert not parse_header("Speed [rpm]").motor


def test_header_unit_is_read_from_brackets_or_an_argument_not_from_a_suffix() -> None:
    assert parse_header("Speed_m [rpm]").unit == "rpm"
    assert parse_header("position[0]").unit == ""
    assert parse_header("Kraft", "kN").unit == "kN"
