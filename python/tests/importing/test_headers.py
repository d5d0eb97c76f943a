"""Column headers of instruments: the unit and the quantity that are read from each."""

from __future__ import annotations

import pytest
from jbf.importing.columns import understood

# Header, its unit, the quantity.
KNOWN = [
    ("time_s", "s", "time"),
    ("Zeit", "", "time"),
    ("t[ms]", "ms", "time"),
    ("Elapsed Time (sec)", "sec", "time"),
    ("time_ms", "ms", "time"),
    ("Kraft [N]", "N", "force"),
    ("Kraft in kN", "kN", "force"),
    ("Force / kN", "kN", "force"),
    ("Reibkraft [N]", "N", "force"),
    ("friction_n", "N", "force"),
    ("Load cell [N]", "N", "force"),
    ("Normalkraft [N]", "N", "load"),
    ("Normal Force (N)", "N", "load"),
    ("Load [kg]", "kg", "load"),
    ("Weg [mm]", "mm", "place"),
    ("Déplacement (mm)", "mm", "place"),
    ("ActPos_mm", "mm", "place"),
    ("x", "", "place"),
    ("Drehwinkel [°]", "°", "place"),
    ("Encoder [counts]", "counts", "place"),
    ("pos (in)", "in", "place"),
    ("Geschwindigkeit mm/s", "mm/s", "speed"),
    ("speed_rpm", "rpm", "speed"),
    ("Drehzahl [U/min]", "U/min", "speed"),
    ("n [min-1]", "min-1", "speed"),
    ("omega (rad/s)", "rad/s", "speed"),
    ("Vitesse de rotation (tr/min)", "tr/min", "speed"),
    ("motor_velocity_rad_s", "rad/s", "speed"),
    ("Torque, Nm", "Nm", "torque"),
    ("Torque [N-m]", "N-m", "torque"),
    ("Couple [N.m]", "N.m", "torque"),
    ("torque_pct", "%", "torque"),
    ("tau {mNm}", "mNm", "torque"),
    ("Strom [A]", "A", "current"),
    ("Iq (mA)", "mA", "current"),
    ("motor current <A>", "A", "current"),
    ("Temperatur Öl [°C]", "°C", "temperature"),
    ("Oil Temperature (°F)", "°F", "temperature"),
    ("pressure_pa", "Pa", "pressure"),
    ("Hydraulikdruck / MPa", "MPa", "pressure"),
    ("Spannung [V]", "V", "voltage"),
    ("coefficient of friction", "", "coefficient"),
    ("Reibwert µ", "", "coefficient"),
    ("Sample #", "", "index"),
    ("Versuch", "", "run"),
    ("Kanal 7", "", None),
    ("Status", "", None),
]


@pytest.mark.parametrize(("header", "unit", "kind"), KNOWN, ids=[row[0] for row in KNOWN])
def test_unit_and_quantity_are_read_from_a_header(header: str, unit: str, kind: str | None) -> None:
    result = understood(header)
    assert (result.unit, result.kind) == (unit, kind)


@pytest.mark.parametrize(
    "header",
    ["setpoint_rpm", "Soll-Drehzahl [1/min]", "pos_ref_mm", "Consigne (N)", "Target Speed (rpm)"],
)
def test_header_of_a_set_point_is_distinguished_from_that_of_a_measurement(header: str) -> None:
    assert understood(header).setpoint
    assert not understood(header.replace("Soll-", "Ist-").replace("Target", "Actual")).setpoint or (
        "ref" in header or "setpoint" in header or "Consigne" in header
    )


def test_symbols_f_and_t_are_read_as_force_and_time() -> None:
    assert understood("F_N [N]").kind == "force"
    assert understood("T [°C]").kind == "time"  # the guess rejects it later by its unit


def test_motor_speed_is_distinguished_from_other_speeds() -> None:
    assert understood("Motor Speed [rpm]").motor
    assert not understood("Speed [rpm]").motor


def test_unit_is_read_from_brackets_or_an_argument_and_not_from_a_suffix_or_an_index() -> None:
    assert understood("Speed_m [rpm]").unit == "rpm"
    assert understood("position[0]").unit == ""
    assert understood("Kraft", "kN").unit == "kN"
