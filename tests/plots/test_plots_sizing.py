"""Figures of sizings: what is drawn where, read back from the drawn artists."""

from __future__ import annotations

import io
from functools import cache

import numpy as np
import pytest
from helpers.duty import paper_motion
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import puma_septic as ps
from puma_septic.pictures.sizing import sizing_pictures, torque_speed_picture

RPM = 60 / (2 * np.pi)


@cache
def chosen() -> ps.Sizing:
    cycle = ps.cycle.with_return(paper_motion(), dwell=0.5)
    sizing = ps.size(cycle, catalogue=ps.built_in_catalogue(), keep=1).sizing
    assert sizing is not None
    return sizing


@cache
def own(*, loaded: bool = False) -> ps.Sizing:
    cycle = ps.Cycle(steps=[paper_motion(loaded=loaded)])
    return ps.size(cycle, drivetrains=ps.load_drivetrains(cycle.robot))


def line(panel: Axes, k: int) -> tuple[np.ndarray, np.ndarray]:
    x, y = panel.lines[k].get_data()
    return np.asarray(x, dtype=float), np.asarray(y, dtype=float)


def texts(figure: Figure) -> set[str]:
    return {text.get_text() for legend in figure.legends for text in legend.get_texts()}


def test_torque_over_speed_stays_in_its_envelope() -> None:
    figure = ps.plots.plot_torque_speed(chosen())
    assert len(figure.axes) == 6
    for panel, d in zip(figure.axes, chosen().demands, strict=True):
        speed, torque = line(panel, 0)
        assert np.abs(torque).max() == pytest.approx(d.peak_torque.size, rel=1e-3)  # 480 samples of the cycle
        assert np.abs(speed).max() == pytest.approx(d.peak_speed.size * RPM, rel=1e-3, abs=1e-9)
        x, y = line(panel, 1)
        assert x.max() == pytest.approx(d.train.motor.peak_curve[-1, 0] * RPM)
        assert y.max() == -y.min() == d.train.motor.peak_curve[0, 1]
        dot = next(one.get_data() for one in panel.lines if len(one.get_xdata()) == 1)
        assert (dot[0][0], dot[1][0]) == (d.mean_speed * RPM, d.rms_torque)
    voltage = "bus voltage, winding at its warmest"
    assert texts(figure) == {"cycle", "RMS torque at mean speed", "for a short time", "continuous (S1)", voltage}


def test_the_line_of_the_bus_voltage_and_the_drive_s_peak_current() -> None:
    """Both limits were checked, and not drawn."""
    motor = ps.Motor(rotor_inertia=1e-4, torque_constant=0.1, resistance=0.5, pole_pairs=4, inductance=5e-4)
    drive = ps.Drive(bus_voltage=8.0, peak_current=0.1)
    train = ps.Drivetrain(motor=motor, gearbox=ps.Gearbox(ratio=100.0, efficiency=0.8), drive=drive)
    sizing = ps.size(own().cycle, drivetrains=[train] * 6)
    (panel, *_) = torque_speed_picture(sizing).panels
    lines = [curve for curve in panel.curves if curve.line == panel.curves[-1].line]
    for speed, torque in ((curve.x / RPM, curve.y) for curve in lines):
        current = torque / 0.1
        voltage = np.hypot(0.5 * current + 0.1 * speed, 4 * 5e-4 * speed * current)
        np.testing.assert_allclose(voltage, 8.0, rtol=1e-12)
    assert len(lines) == 2
    assert sorted(rule.at for rule in panel.levels) == pytest.approx([-0.01, 0.01])
    told = {"bus voltage, winding at its warmest", "peak current of the drive"}
    assert told <= texts(ps.plots.plot_torque_speed(sizing))


def test_the_limit_of_the_whole_actuator_is_drawn_at_the_motor() -> None:
    panel = ps.plots.plot_torque_speed(own()).axes[1]
    x, y = line(panel, 1)
    assert y.max() == pytest.approx(97.0 / 107.815)
    assert x.max() == pytest.approx(163.0 * RPM)


def test_no_known_limit_is_said() -> None:
    trains = [ps.Drivetrain(motor=ps.Motor(), gearbox=ps.Gearbox(ratio=100.0))] * 6
    sizing = ps.size(own().cycle, drivetrains=trains)
    assert ps.plots.plot_torque_speed(sizing).axes[0].get_title(loc="right") == "no torque limit known"
    with pytest.raises(ps.InputError, match="no limit of the drive trains is known"):
        ps.plots.plot_sizing_utilisation(sizing)
    assert [picture.name for picture in sizing_pictures(sizing)] == ["torque-speed", "torque-split", "ratio-sweep"]


def test_every_check_has_a_bar_and_its_number() -> None:
    figure = ps.plots.plot_sizing_utilisation(chosen())
    names = [label.get_text().removesuffix(" (?)") for label in figure.axes[0].get_yticklabels()]
    for panel, joint in zip(figure.axes, chosen().cycle.joint_names, strict=True):
        checks = {check.quantity: check for check in chosen().checks if check.joint == joint}
        lengths = {round(bar.get_y() + bar.get_height() / 2): bar.get_width() for bar in panel.patches}
        for row, name in enumerate(names):
            text = panel.texts[row].get_text()
            if name not in checks:
                assert (text, lengths[row]) == ("not assessed", 0.0)
                continue
            percent = 100 * checks[name].utilisation
            assert text == f"{percent:.0f} %{' !' if checks[name].is_violated else ''}"
            assert lengths[row] == pytest.approx(min(percent, 125.0), abs=1e-12)
    assert "inertia ratio (?)" in [label.get_text() for label in figure.axes[0].get_yticklabels()]
    hatched = [bar for panel in figure.axes for bar in panel.patches if bar.get_hatch()]
    assert len(hatched) == len(chosen().warnings)


def test_temperature_of_winding_and_housing() -> None:
    panel = ps.plots.plot_winding_temperature(chosen()).axes[1]
    d = chosen().demands[1]
    winding, housing = line(panel, 0)[1], line(panel, 1)[1]
    assert winding.max() == pytest.approx(40.0 + d.peak_temperature_rise.size, rel=1e-4)
    assert (winding > housing).all()
    assert line(panel, 3)[1][0] == 130.0


def test_an_unknown_temperature_says_why() -> None:
    panel = ps.plots.plot_winding_temperature(own()).axes[0]
    assert "needs the motor's torque constant" in panel.texts[0].get_text()


def test_split_of_several_cycles() -> None:
    figure = ps.plots.plot_sizing_torque_split([own(), own(loaded=True)], labels=["empty", "loaded"])
    gravity = [bar.get_width() for bar in figure.axes[1].containers[0]]
    assert gravity == [one.demands[1].rms_by_cause["gravity"] for one in (own(), own(loaded=True))]
    assert texts(figure) == {"gravity", "motion", "gears", "rotor", "friction"}
    with pytest.raises(ps.InputError, match="2 texts are needed"):
        ps.plots.plot_sizing_torque_split([own(), own()], labels=["one"])
    with pytest.raises(ps.InputError, match="got none"):
        ps.plots.plot_sizing_torque_split([])


def test_ratio_sweep_is_that_of_other_gearboxes() -> None:
    """The curve against sizings with other ratios, by the code that sizes any drive train."""
    x, y = line(ps.plots.plot_ratio_sweep(chosen()).axes[1], 0)
    train = chosen().drivetrains[1]
    for k in (0, len(x) // 2, -1):
        other = ps.Drivetrain(motor=train.motor, gearbox=_with_ratio(train.gearbox, float(x[k])), drive=train.drive)
        trains = [*chosen().drivetrains[:1], other, *chosen().drivetrains[2:]]
        again = ps.size(chosen().cycle, drivetrains=trains)
        assert y[k] == pytest.approx(again.demands[1].rms_torque, rel=1e-9)


def _with_ratio(gearbox: ps.Gearbox, ratio: float) -> ps.Gearbox:
    names = ("name", "efficiency", "backward_efficiency", "inertia", "no_load_torque")
    return ps.Gearbox(ratio=ratio, **{name: getattr(gearbox, name) for name in names})


@pytest.mark.slow
def test_all_figures_have_units_and_can_be_written() -> None:
    for picture in sizing_pictures(chosen()):
        name, figure = picture.name, ps.plots.draw(picture)
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png")
        assert len(buffer.getvalue()) > 10_000, name
        labels = [label for panel in figure.axes for label in (panel.get_xlabel(), panel.get_ylabel()) if label]
        assert labels
        assert all("[" in label for label in labels), (name, labels)
