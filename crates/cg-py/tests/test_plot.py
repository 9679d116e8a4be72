"""Figures: what they show, their units, and that the docstrings explain how to read them."""

from __future__ import annotations

import inspect
import tomllib

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
import scipy.signal
from matplotlib.figure import Figure

import cgheight
from cgheight import plot
from conftest import FIXTURES, ONE_TURN
from test_arx import noisy_second_order

DRIVE = FIXTURES / "logs" / "F_drive1_p15_h155.csv.gz"


@pytest.fixture(autouse=True)
def closed():
    """Draw without a screen, and close every figure after its test."""
    plt.switch_backend("agg")
    yield
    plt.close("all")


def drawn(figure: Figure, path) -> np.ndarray:
    """Save a figure as PNG and return its pixels; it is not empty and wide enough for a report."""
    figure.savefig(path)
    pixels = plt.imread(path)
    assert pixels.shape[1] >= 600
    assert np.mean(np.any(pixels[:, :, :3] < 0.9, axis=2)) > 0.01
    return pixels


def test_every_picture_says_how_to_read_it_and_what_its_axes_are():
    for name in plot.__all__:
        text = inspect.getdoc(getattr(plot, name))
        assert "How to read it:" in text, name
        for heading in ("Parameters", "Returns", "Raises"):
            assert heading in text, (name, heading)
        for parameter in inspect.signature(getattr(plot, name)).parameters:
            assert parameter in text, (name, parameter)


def test_a_log_with_its_maneuvers_and_predicted_roll(kraz, turn, tmp_path):
    figure = plot.log(turn, vehicle=kraz)
    drawn(figure, tmp_path / "log.png")
    answer = cgheight.estimate(**turn, vehicle=kraz)
    inputs, roll, rest = figure.axes[:3]
    assert f"height {answer.height_m:.2f} m" in inputs.get_title(loc="left")
    measured, predicted = roll.get_lines()[:2]
    # After two lags of 0.15 s, half of the turn's roll angle is reached 0.3 s later.
    drawn_deg, given_deg = measured.get_ydata(), np.degrees(turn["roll_rad"])
    half_s = [
        turn["time_s"][np.argmax(angle > 0.5 * given_deg[-1])] for angle in (drawn_deg, given_deg)
    ]
    assert half_s[0] - half_s[1] == pytest.approx(0.3, abs=0.05)
    assert drawn_deg[-1] == pytest.approx(given_deg[-1], abs=0.001)
    expected = cgheight.predict_roll(turn, answer.height_m, vehicle=kraz)
    offset = np.mean(np.radians(drawn_deg) - expected)
    assert predicted.get_ydata() == pytest.approx(np.degrees(expected + offset), abs=1e-12)
    assert np.mean(rest.get_lines()[0].get_ydata()) == pytest.approx(0.0, abs=1e-12)
    assert [axes.get_ylabel().split("(")[-1] for axes in figure.axes[:3]] == ["°)"] * 3
    assert rest.get_xlabel() == "time (s)"
    shades = [patch for patch in roll.patches if patch.get_width() > 0]
    assert len(shades) == len(answer.maneuvers)
    assert shades[0].get_x() == answer.maneuvers[0].start_s


def test_logs_without_a_height_or_a_steer_angle_are_drawn_too(kraz, turn, tmp_path):
    straight = {name: column[:150] for name, column in turn.items()}
    figure = plot.log(straight, vehicle=kraz)
    drawn(figure, tmp_path / "straight.png")
    assert "rejected" in figure.axes[0].get_title(loc="left")
    tilted = {name: column for name, column in turn.items() if name != "steer_rad"}
    tilted["tilt_rad"] = tilted.pop("roll_rad") + turn["lateral_acceleration_mps2"] / 9.81
    figure = plot.log(tilted, vehicle=kraz)
    assert "acceleration (g)" in figure.axes[0].get_ylabel()


def test_the_height_over_time_ends_with_the_answer(kraz, tmp_path):
    figure = plot.height(DRIVE, vehicle=kraz, true_height_m=1.55)
    drawn(figure, tmp_path / "height.png")
    answer = cgheight.estimate_log(DRIVE, vehicle=kraz)
    (axes,) = figure.axes
    steps = next(line for line in axes.get_lines() if line.get_label() == "all turns so far")
    times, heights = steps.get_data()
    assert heights[-1] == answer.height_m
    assert np.all(np.diff(times) >= 0)
    assert len(heights) > 5
    assert axes.get_ylabel() == "c.g. height (m)"


def test_a_log_of_one_turn_has_a_line_over_the_turn(kraz, turn, tmp_path):
    figure = plot.height(turn, vehicle=kraz)
    drawn(figure, tmp_path / "one.png")
    answer = cgheight.estimate(**turn, vehicle=kraz)
    (axes,) = figure.axes
    times, heights = axes.get_lines()[0].get_data()
    assert list(times) == [answer.maneuvers[0].start_s, turn["time_s"][-1]]
    assert list(heights) == [answer.height_m] * 2
    assert axes.get_xlim()[1] > answer.maneuvers[0].end_s  # the point is not on the border
    # A drive that ends in a turn: this turn counts from its beginning, and time does not go back.
    drive = cgheight.read_log(DRIVE)
    part = drive[drive.time_s < drive.time_s.iloc[-1] / 2]
    # The last samples may wait for others to be averaged with.
    while (
        cgheight.estimate_log(part, vehicle=kraz).maneuvers[-1].end_s < part.time_s.iloc[-1] - 0.09
    ):
        part = part[:-50]
    times = plot.height(part, vehicle=kraz).axes[0].get_lines()[0].get_xdata()
    assert np.all(np.diff(times) >= 0)
    assert times[-2] < times[-1] - 1.0


def test_figures_of_a_file_have_its_name(kraz, turn):
    path = FIXTURES / "logs" / ONE_TURN
    for draw in (plot.log, plot.height):
        for log, named in ((path, True), (str(path), True), (turn, False)):
            title = draw(log, vehicle=kraz).axes[0].get_title(loc="left")
            assert title.startswith(f"{ONE_TURN}\n" if named else "c.g. height")


def test_the_magnitude_of_a_bode_plot_has_the_unit_of_its_models(baseline):
    u, y = noisy_second_order()
    model, linear = cgheight.arx(u, y, 2, 2, 1, 0.05), cgheight.linear_model(baseline)
    for models, unit, expected in (
        ((model,), None, "(output per input)"),
        ((model, linear.reduced), None, "(rad of roll per rad of steer)"),
        ((model,), "rad per m/s²", "(rad per m/s²)"),
    ):
        figure = plot.bode(*models, unit=unit)
        assert figure.axes[0].get_ylabel().split("\n")[1] == expected
    # A slow model is drawn below half of its sampling rate.
    slow = cgheight.arx(u, y, 2, 2, 1, 60.0)
    hz = plot.bode(slow).axes[0].get_lines()[0].get_xdata()
    assert (hz[0], hz[-1]) == (pytest.approx(0.01 / 120), pytest.approx(1 / 120))
    refined = cgheight.output_error(u, y, model)
    figure = plot.bode(refined)
    assert figure.axes[0].get_lines()[0].get_label() == "output error [2 2 1], identified"
    assert len(figure.axes[0].collections) == 1  # its band


def test_a_bode_plot_draws_the_responses_and_a_band_of_the_right_width(baseline, tmp_path):
    u, y = noisy_second_order(2000)
    model = cgheight.arx(u, y, 2, 2, 1, 0.05)
    linear = cgheight.linear_model(baseline)
    figure = plot.bode(model, linear, linear.reduced, linear.to_control(), labels=list("abcd"))
    drawn(figure, tmp_path / "bode.png")
    upper = figure.axes[0]
    assert [line.get_label() for line in upper.get_lines()] == list("abcd")
    hz, size = upper.get_lines()[1].get_data()
    expected = np.abs(linear.transfer_function.response(2 * np.pi * hz))
    assert size == pytest.approx(expected, rel=1e-12)
    assert upper.get_lines()[3].get_ydata() == pytest.approx(expected, rel=1e-6)
    # The left end is the DC gain, where the band is 1.96 of its standard deviations.
    figure = plot.bode(model, frequency_hz=[1e-6, 0.1])
    corners = figure.axes[0].collections[0].get_paths()[0].vertices
    at_left = corners[np.isclose(corners[:, 0], 1e-6), 1]
    ratio = np.sqrt(at_left.max() / at_left.min())
    assert np.log(ratio) == pytest.approx(1.96 * model.dc_gain_sd / model.dc_gain, rel=1e-3)
    with pytest.raises(ValueError, match="no model to draw"):
        plot.bode()
    with pytest.raises(ValueError, match="1 labels for 2 models"):
        plot.bode(model, linear, labels=["a"])
    with pytest.raises(ValueError, match="type int has no transfer function"):
        plot.bode(3)


def test_roots_are_drawn_where_they_are(baseline, tmp_path):
    linear = cgheight.linear_model(baseline)
    ts = 0.01
    poles = np.exp(linear.reduced.transfer_function.poles * ts)
    sampled = cgheight.TransferFunction(np.array([]), poles, 1.0, ts)
    figure = plot.pole_zero(linear, sampled)
    drawn(figure, tmp_path / "roots.png")
    marks = [np.asarray(one.get_offsets()) for one in figure.axes[0].collections]
    assert np.allclose(marks[0] @ [1, 1j], linear.poles, atol=1e-12)
    # Sampled and converted back: the logarithm of poles inside the unit circle.
    assert np.allclose(marks[2] @ [1, 1j], linear.reduced.transfer_function.poles, atol=1e-9)
    assert "more beyond 15 rad/s" in figure.axes[0].get_title(loc="left")
    with pytest.raises(ValueError, match="reach_radps is 0"):
        plot.pole_zero(linear, reach_radps=0)


def test_residuals_that_are_white_stay_in_the_band_and_others_do_not(tmp_path):
    random = np.random.default_rng(5)
    u = random.standard_normal(3000)
    y = np.zeros(3000)
    e = 0.1 * random.standard_normal(3000)
    for t in range(2, 3000):
        y[t] = 1.2 * y[t - 1] - 0.5 * y[t - 2] + u[t - 1] + e[t]
    right, wrong = cgheight.arx(u, y, 2, 1, 1, 0.1), cgheight.arx(u, y, 1, 1, 1, 0.1)
    figures = [plot.residuals(model, u, y) for model in (right, wrong)]
    drawn(figures[0], tmp_path / "white.png")
    # Each lag is outside with probability 0.01. More than 3 of 25 lags, or 4 of 51, are outside
    # with probability 1e-4.
    for panel, allowed in ((0, 3), (1, 4)):
        titles = [figure.axes[panel].get_title(loc="left") for figure in figures]
        outside = [int(title.split(": ")[1].split()[0]) for title in titles]
        assert outside[0] <= allowed < outside[1]
    # With white noise on the output, the residuals of the output-error model are white.
    y = scipy.signal.lfilter([0.0, 1.0], [1.0, -1.2, 0.5], u) + 0.5 * random.standard_normal(3000)
    arx = cgheight.arx(u, y, 2, 1, 1, 0.1)
    counts = []
    for model in (cgheight.output_error(u, y, arx), arx):
        title = plot.residuals(model, u, y).axes[0].get_title(loc="left")
        counts.append(int(title.split(": ")[1].split()[0]))
    assert counts[0] <= 3 < counts[1]
    with pytest.raises(ValueError, match="lags is 0"):
        plot.residuals(right, u, y, lags=0)


def test_an_accuracy_map_has_its_numbers_in_its_cells(tmp_path):
    table = pd.DataFrame(
        {"height_m": [1.5, 1.5, 2.0, 2.0], "snr_db": [10, 20, 10, 20],
         "rmse_percent": [2.0, 0.5, 2.5, np.nan], "bias_percent": [0.1, -0.2, 0.0, 0.3],
         "coverage_percent": [94.0, 95, 96, 97]}
    )  # fmt: skip
    figure = plot.accuracy_map(table)
    drawn(figure, tmp_path / "map.png")
    assert [text.get_text() for text in figure.axes[0].texts] == ["2.00", "0.50", "2.50", "–"]
    bar = figure.axes[1].yaxis.label
    assert bar.get_text().replace("\n", " ") == "root mean square error of the height (%)"
    for value in ("rmse_percent", "bias_percent", "coverage_percent"):
        figure = plot.accuracy_map(table, value=value)
        drawn(figure, tmp_path / f"{value}.png")
        # No text is clipped, also that along the bar.
        for axes in figure.axes:
            for text in (axes.xaxis.label, axes.yaxis.label):
                box = text.get_window_extent()
                assert box.y0 >= 0
                assert box.y1 <= figure.bbox.height
    with pytest.raises(ValueError, match="no column rmse; it has height_m"):
        plot.accuracy_map(table, value="rmse")
    with pytest.raises(ValueError, match="several rows have the same"):
        plot.accuracy_map(pd.concat([table, table]))


def test_the_figure_of_a_file_is_that_of_its_arrays(kraz, turn):
    by_path = plot.log(FIXTURES / "logs" / ONE_TURN, vehicle=kraz)
    by_arrays = plot.log(turn, vehicle=kraz)
    lines = [figure.axes[1].get_lines()[1].get_ydata() for figure in (by_path, by_arrays)]
    assert lines[0] == pytest.approx(lines[1], abs=1e-9)


def test_the_heights_of_many_logs_with_their_names(kraz, turn, tmp_path):
    straight = {name: column[:150] for name, column in turn.items()}
    logs = {"north": turn, "south": turn, "straight": straight}
    answers = cgheight.estimate_logs(logs, vehicle=kraz)
    figure = plot.heights(answers, true_heights_m={"north": 1.7})
    drawn(figure, tmp_path / "heights.png")
    (axes,) = figure.axes
    assert [label.get_text() for label in axes.get_yticklabels()] == list(logs)
    # Two logs with bar and point, and one true height.
    assert [line.get_xdata()[0] for line in axes.get_lines()] == [
        answers[0].height_ci95_m[0], answers[0].height_m,
        answers[1].height_ci95_m[0], answers[1].height_m, 1.7,
    ]  # fmt: skip
    assert [text.get_text() for text in axes.texts] == ["no height: rejected"]
    with pytest.raises(ValueError, match="no log to draw"):
        plot.heights(cgheight.estimate_logs([], vehicle=kraz))


def test_logs_of_the_same_name_are_told_apart(kraz, turn):
    answer = cgheight.estimate(**turn, vehicle=kraz)

    def labels(*logs, **options):
        figure = plot.heights(cgheight.Estimates(logs, (answer,) * len(logs)), **options)
        (axes,) = figure.axes
        return [label.get_text() for label in axes.get_yticklabels()], axes

    assert labels("/data/mon/log.csv", "/data/tue/log.csv", "table 2")[0] == [
        "mon/log.csv", "tue/log.csv", "table 2",
    ]  # fmt: skip
    assert labels("mon/log.csv", "mon/other.csv")[0] == ["log.csv", "other.csv"]
    assert labels("mon/log.csv", "/data/log.csv")[0] == ["mon/log.csv", "/data/log.csv"]
    _, axes = labels("mon/log.csv", "tue/log.csv", true_heights_m={"tue/log.csv": 1.5})
    assert [line.get_xdata()[0] for line in axes.get_lines()].count(1.5) == 1
    with pytest.raises(ValueError, match=r"log\.csv: several logs have this name"):
        labels("mon/log.csv", "tue/log.csv", true_heights_m={"log.csv": 1.5})


def test_what_a_calibration_moved_is_drawn_in_units_of_the_vehicle_file(kraz, tmp_path):
    path = tmp_path / "truck.toml"
    logs = FIXTURES / "logs"
    cgheight.calibrate(
        kraz, [(logs / "A_p00_v50_L.csv", "empty"), (logs / "A_p20_h190_v50_L.csv", 1.9)], path
    )
    figure = plot.calibration(path)
    drawn(figure, tmp_path / "calibration.png")
    (axes,) = figure.axes
    known = {
        one["name"].replace("_", " "): one for one in tomllib.loads(path.read_text())["parameter"]
    }
    labels = [label.get_text() for label in axes.get_yticklabels()]
    places = axes.get_lines()[0].get_xdata()
    assert len(labels) == len(places) > 5
    for label, place, text in zip(labels, places, axes.texts, strict=True):
        one = known[label]
        nominal = 1.0 if one["unit"] == "factor" else 0.0
        assert place == pytest.approx((one["value"] - nominal) / one["prior_sd"], abs=1e-12)
        assert float(text.get_text().split()[0]) == pytest.approx(one["value"], abs=5e-4)
    shares = [known[label]["sd"] / known[label]["prior_sd"] for label in labels]
    assert shares == sorted(shares)
    assert shares[-1] <= 0.99
    # All that are not drawn were not determined.
    others = [one for name, one in known.items() if name not in labels]
    assert others
    assert all(one["sd"] >= 0.99 * one["prior_sd"] for one in others)
    with pytest.raises(ValueError, match="is not a calibration"):
        plot.calibration(logs / "truth.json")
    with pytest.raises(ValueError, match="is not a calibration: 'parameter'"):
        plot.calibration(FIXTURES / "vehicles" / "kraz.toml")
