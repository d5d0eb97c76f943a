"""What columns are called in the world: a table of headers, and what each must be taken for."""

from __future__ import annotations

import pytest
from jbf.importing.columns import understood

# Header, its unit, the quantity.
KNOWN = [
    ("time_s", "s", "time"),
    ("Zeit", "", "time"),
    ("Zeit [s]", "s", "time"),
    ("t[ms]", "ms", "time"),
    ("t/s", "s", "time"),
    ("Temps (s)", "s", "time"),
    ("Time stamp", "", "time"),
    ("Elapsed Time (sec)", "sec", "time"),
    ("time_ms", "ms", "time"),
    ("Kraft [N]", "N", "force"),
    ("Kraft N", "N", "force"),
    ("Kraft in kN", "kN", "force"),
    ("Force (N)", "N", "force"),
    ("Force / kN", "kN", "force"),
    ("Reibkraft [N]", "N", "force"),
    ("Friction Force (N)", "N", "force"),
    ("friction_n", "N", "force"),
    ("Effort (N)", "N", "force"),
    ("Load cell [N]", "N", "force"),
    ("force_lbf", "lbf", "force"),
    ("Normalkraft [N]", "N", "load"),
    ("Normal Force (N)", "N", "load"),
    ("Normal load (N)", "N", "load"),
    ("Load [kg]", "kg", "load"),
    ("load_kn", "kN", "load"),
    ("Weg [mm]", "mm", "place"),
    ("Position (µm)", "µm", "place"),
    ("Déplacement (mm)", "mm", "place"),
    ("ActPos_mm", "mm", "place"),
    ("x", "", "place"),
    ("Hub / mm", "mm", "place"),
    ("Drehwinkel [°]", "°", "place"),
    ("angle_deg", "deg", "place"),
    ("Encoder [counts]", "counts", "place"),
    ("pos (in)", "in", "place"),
    ("Geschwindigkeit mm/s", "mm/s", "speed"),
    ("Geschwindigkeit [m/min]", "m/min", "speed"),
    ("Vitesse (mm/s)", "mm/s", "speed"),
    ("speed_rpm", "rpm", "speed"),
    ("Drehzahl [U/min]", "U/min", "speed"),
    ("Drehzahl [1/min]", "1/min", "speed"),
    ("n [min-1]", "min-1", "speed"),
    ("Spindeldrehzahl [rpm]", "rpm", "speed"),
    ("omega (rad/s)", "rad/s", "speed"),
    ("Vitesse de rotation (tr/min)", "tr/min", "speed"),
    ("motor_velocity_rad_s", "rad/s", "speed"),
    ("Torque, Nm", "Nm", "torque"),
    ("Torque [N-m]", "N-m", "torque"),
    ("Drehmoment [Ncm]", "Ncm", "torque"),
    ("Couple [N.m]", "N.m", "torque"),
    ("torque_pct", "%", "torque"),
    ("Moment [%]", "%", "torque"),
    ("tau {mNm}", "mNm", "torque"),
    ("Strom [A]", "A", "current"),
    ("Iq (mA)", "mA", "current"),
    ("motor current <A>", "A", "current"),
    ("Temperatur Öl [°C]", "°C", "temperature"),
    ("temp_c", "°C", "temperature"),
    ("Oil Temperature (°F)", "°F", "temperature"),
    ("Druck [bar]", "bar", "pressure"),
    ("pressure_pa", "Pa", "pressure"),
    ("Hydraulikdruck / MPa", "MPa", "pressure"),
    ("Spannung [V]", "V", "voltage"),
    ("coefficient of friction", "", "coefficient"),
    ("Reibwert µ", "", "coefficient"),
    ("Sample #", "", "index"),
    ("Lfd. Nr", "", "index"),
    ("Versuch", "", "run"),
    ("Kanal 7", "", None),
    ("Status", "", None),
]


@pytest.mark.parametrize(("header", "unit", "kind"), KNOWN, ids=[row[0] for row in KNOWN])
def test_a_header_is_understood(header: str, unit: str, kind: str | None) -> None:
    found = understood(header)
    assert (found.unit, found.kind) == (unit, kind)


@pytest.mark.parametrize(
    "header",
    ["setpoint_rpm", "Soll-Drehzahl [1/min]", "pos_ref_mm", "Consigne (N)", "Target Speed (rpm)"],
)
def test_what_was_asked_for_is_not_what_was_measured(header: str) -> None:
    assert understood(header).setpoint
    assert not understood(header.replace("Soll-", "Ist-").replace("Target", "Actual")).setpoint or (
        "ref" in header or "setpoint" in header or "Consigne" in header
    )


def test_the_unit_decides_between_quantities_of_one_name() -> None:
    assert understood("F_N [N]").kind == "force"
    assert understood("T [°C]").kind == "time"  # the guess sees that the unit is no time's
    assert understood("Motor Speed [rpm]").motor
    assert not understood("Speed [rpm]").motor


def test_a_units_place_is_taken_before_a_words_end() -> None:
    assert understood("Speed_m [rpm]").unit == "rpm"
    assert understood("position[0]").unit == ""
    assert understood("Kraft", "kN").unit == "kN"
