"""Identification next to python-control, statsmodels and scipy, and on data with known truth."""

from __future__ import annotations

from dataclasses import replace

import control
import numpy as np
import pytest
import scipy.optimize
import scipy.signal
import scipy.stats
from statsmodels.datasets import macrodata
from statsmodels.tsa.ar_model import AutoReg
from statsmodels.tsa.tsatools import detrend as statsmodels_detrend

import cgheight
from conftest import FIXTURES

A, B = np.array([1.0, -1.5, 0.7]), np.array([0.0, 0.1, 0.05])
EPSILON = np.finfo(float).eps


def furnace():
    """Return gas rate (ft³/min) and CO2 (%) of a gas furnace every 9 s, without their means.

    Series J of Box and Jenkins, Time Series Analysis, as the library darts stores it (Apache-2.0).
    """
    data = np.genfromtxt(FIXTURES / "arx" / "gas_furnace.csv", delimiter=",", names=True)
    return cgheight.detrend(data["u"]), cgheight.detrend(data["y"])


def economy():
    """Return quarterly growth (%) of US income and consumption (in the public domain)."""
    table = macrodata.load_pandas().data
    growth = [100 * np.diff(np.log(table[name])) for name in ("realdpi", "realcons")]
    return cgheight.detrend(growth[0]), cgheight.detrend(growth[1])


def regression(u, y, na, nb, nk):
    """Return the fit of statsmodels, which has the past outputs and then the inputs."""
    lags = [np.concatenate([np.zeros(k), u[: len(u) - k]]) for k in range(nk, nk + nb)]
    memory = max(na, nb + nk - 1)
    return AutoReg(y, na, trend="n", exog=np.column_stack(lags), hold_back=memory).fit()


def noisy(random, rows, noise_sd=0.0, of="equation"):
    """Return input and output of the known model."""
    u = np.repeat(random.standard_normal(rows // 4), 4)
    e = noise_sd * random.standard_normal(len(u))
    y = scipy.signal.lfilter(B, A, u)
    return u, y + (scipy.signal.lfilter([1.0], A, e) if of == "equation" else e)


def by_hand(model, u, y, k):
    """Predict each row by the recursion, beginning k rows before it or at the model's memory."""
    predicted = np.full(len(y), np.nan)
    for t in range(model.memory, len(y)):
        first = max(t - k + 1, model.memory)
        past = list(y[:first])
        for row in range(first, t + 1):
            drive = sum(b * u[row - j] for j, b in enumerate(model.b))
            past.append(drive - sum(a * past[row - i] for i, a in enumerate(model.a) if i))
        predicted[t] = past[t]
    return predicted


@pytest.mark.parametrize(("data", "orders"), [(furnace, (2, 3, 3)), (economy, (2, 2, 0))])
def test_the_same_model_as_statsmodels_and_the_same_predictions(data, orders):
    u, y = data()
    model, fit = cgheight.arx(u, y, *orders, 9.0), regression(u, y, *orders)
    theta = np.concatenate([-model.a[1:], model.b[model.nk :]])
    # Both lose ε times the condition number of the regressors, below 1e3 here.
    assert theta == pytest.approx(fit.params, rel=1e-9)
    sd = np.sqrt(np.diag(model.covariance))
    # statsmodels divides by the number of rows.
    freedom = fit.nobs / (fit.nobs - len(theta))
    assert sd == pytest.approx(fit.bse * np.sqrt(freedom), rel=1e-9)
    assert model.predict(u, y)[model.memory :] == pytest.approx(fit.fittedvalues, abs=1e-9)
    start = model.memory
    free = fit.predict(start=start, end=len(y) - 1, dynamic=True)
    assert model.free_run(u, y)[start:] == pytest.approx(free, abs=1e-9)
    one = model.compare(u, y)
    seen = y[start:]
    for run, percent in ((fit.fittedvalues, one.one_step_percent), (free, one.free_run_percent)):
        error = np.sqrt(np.mean((seen - run) ** 2) / np.mean((seen - np.mean(seen)) ** 2))
        assert percent == pytest.approx(100 * (1 - error), abs=1e-8)


def test_the_fit_of_the_gas_furnace_one_step_ahead_hides_that_of_the_free_run():
    u, y = furnace()
    compared = cgheight.arx(u, y, 2, 3, 3, 9.0).compare(u, y)
    assert repr(compared) == "Comparison(one step ahead 92.3 %, free run 73.0 %, 296 rows)"
    assert "73.0 %" in compared._repr_html_()


@pytest.mark.parametrize("orders", [(2, 3, 3), (0, 3, 1), (3, 1, 0), (1, 2, 6)])
@pytest.mark.parametrize("k", [1, 2, 3, 7, 40])
def test_predictions_of_k_steps_are_those_of_the_recursion(orders, k):
    u, y = (signal[:60] for signal in furnace())
    model = cgheight.arx(u, y, *orders, 9.0)
    expected = by_hand(model, u, y, k)
    # Rounding: ε times the number of terms, k times 12, and the largest value; a model with an
    # unstable pole grows to 1e7.
    error = 12 * k * EPSILON * np.nanmax(np.abs(expected))
    assert model.predict(u, y, k) == pytest.approx(expected, abs=error, nan_ok=True)
    free = model.predict(u, y, np.inf)
    assert free == pytest.approx(model.free_run(u, y), abs=0, nan_ok=True)
    assert model.predict(u, y, 10_000) == pytest.approx(free, abs=0, nan_ok=True)


def test_the_error_of_k_steps_grows_as_the_noise_model_says():
    random = np.random.default_rng(4)
    u, y = noisy(random, 40_000, 0.1)
    model = replace(cgheight.arx(u, y, 2, 2, 1, 0.05), a=A, b=B)
    weights = scipy.signal.lfilter([1.0], A, np.eye(1, 20)[0])
    for k in (1, 2, 5, 20):
        error = (y - model.predict(u, y, k))[model.memory + k :]
        expected = 0.01 * np.sum(weights[:k] ** 2)
        # A variance of n values whose memory is k + 20 scatters by less than sqrt(2 (k+20) / n).
        spread = np.sqrt(2 * (k + 20) / len(error))
        assert np.mean(error**2) == pytest.approx(expected, rel=4 * spread)


def test_responses_roots_and_simulation_are_those_of_python_control():
    u, y = furnace()
    for model in (cgheight.arx(u, y, 2, 3, 3, 9.0), cgheight.arx(u, y, 3, 2, 0, 9.0)):
        top, bottom = np.zeros(model.memory + 1), np.zeros(model.memory + 1)
        top[: len(model.b)], bottom[: len(model.a)] = model.b, model.a
        system = control.tf(top, bottom, model.ts)
        # A double root at zero, which a delay has, is lost to sqrt(ε).
        for own, theirs in ((model.poles, system.poles()), (model.zeros, system.zeros())):
            assert np.sort_complex(own) == pytest.approx(np.sort_complex(theirs), abs=1e-7)
        omega = np.array([1e-3, 0.01, 0.1, 0.3])
        size, phase, _ = control.frequency_response(system, omega)
        bode = model.bode(omega)
        assert bode.magnitude == pytest.approx(size, rel=1e-9)
        turns = (bode.phase_rad - phase) / (2 * np.pi)
        assert turns == pytest.approx(np.round(turns), abs=1e-9)
        step = model.step(900.0)
        times, expected = control.step_response(system, T=step.time_s)
        assert step.time_s == pytest.approx(times)
        assert step.response == pytest.approx(expected, abs=1e-10)
        _, expected = control.forced_response(system, 9.0 * np.arange(len(u)), u)
        assert model.simulate(u) == pytest.approx(expected, abs=1e-9)
        assert step.response[-1] == pytest.approx(model.dc_gain, rel=1e-3)
        # The standard deviation of the end is that of the gain.
        long = model.step(9000.0)
        assert long.response_sd[-1] == pytest.approx(model.dc_gain_sd, rel=1e-6)


def test_standard_deviations_of_responses_are_those_of_draws():
    u, y = furnace()
    model = cgheight.arx(u, y, 2, 3, 3, 9.0)
    random, bode, step = np.random.default_rng(3), model.bode([0.01, 0.1]), model.step(200.0)
    theta = np.concatenate([model.a[1:], model.b[3:]])
    drawn = []
    # A hundredth of the standard deviations, so that the first order is accurate.
    for one in random.multivariate_normal(theta, 1e-4 * model.covariance, 2000):
        moved = replace(model, a=np.append(1.0, one[:2]), b=np.append(np.zeros(3), one[2:]))
        value = moved.response([0.01, 0.1])[0]
        drawn.append([*np.abs(value), *np.angle(value), *moved.simulate(np.ones(23))[[4, 8, 22]]])
    stated = [*bode.magnitude_sd, *bode.phase_sd_rad, *step.response_sd[[4, 8, 22]]]
    # A standard deviation of 2000 draws scatters by 1/sqrt(4000), 5 sd.
    assert 100 * np.std(drawn, axis=0) == pytest.approx(stated, rel=5 / np.sqrt(4000))


def test_a_step_lasts_until_the_response_is_steady():
    u, y = noisy(np.random.default_rng(2), 400, 0.01)
    model = cgheight.arx(u, y, 2, 2, 1, 0.05)
    step = model.step()
    assert step.response[-1] == pytest.approx(model.dc_gain, rel=5e-3)
    assert len(model.step(1.0).time_s) == 21
    assert repr(model.step(1.0)) == "StepResponse(21 samples, 1 s)"
    assert repr(model.bode([0.1, 2.0])) == "FrequencyResponse(2 frequencies, 0.1 to 2 rad/s)"
    with pytest.raises(ValueError, match="duration_s is 0"):
        model.step(0)
    assert len(replace(model, a=np.array([1.0, -1.0, 0.0])).step().time_s) == 100


def test_a_simulation_starts_at_zero_or_steady():
    u, y = noisy(np.random.default_rng(2), 400, 0.01)
    model = cgheight.arx(u, y, 2, 2, 1, 0.05)
    u = u + 3.0
    before = np.concatenate([np.full(500, u[0]), u])
    # After 500 samples with poles of 0.84, nothing of the start is left.
    assert model.simulate(u, start="steady") == pytest.approx(model.simulate(before)[500:], 1e-9)
    assert model.simulate(u)[0] == 0.0
    with pytest.raises(ValueError, match="start is 'warm'"):
        model.simulate(u, start="warm")
    with pytest.raises(ValueError, match=r"u\[1\] is nan"):
        model.simulate([1.0, np.nan])
    integrates = replace(model, a=np.array([1.0, -1.0, 0.0]), dc_gain=np.inf)
    with pytest.raises(ValueError, match="no steady state"):
        integrates.simulate(u, start="steady")


def test_a_fitted_start_is_the_one_with_the_least_error():
    u, y = noisy(np.random.default_rng(7), 400, 0.3, "output")
    model = cgheight.output_error(u, y, cgheight.arx(u, y, 2, 2, 1, 0.05))
    u, y = u[50:], y[50:]
    measured, fitted = (model.compare(u, y, start=start) for start in ("measured", "fitted"))
    assert fitted.free_run_percent > measured.free_run_percent
    # The search through all starts: the free run is linear in the two outputs before it.
    m = model.memory
    rest = (y - fitted.free_run)[m:]
    for j in (0, 1):
        natural = scipy.signal.lfilter([1.0], model.a, np.eye(1, len(rest), j)[0])
        # Orthogonal up to rounding of 350 products.
        assert abs(rest @ natural) < 1e3 * EPSILON * np.linalg.norm(rest) * np.linalg.norm(natural)
    assert np.all(np.isnan(fitted.free_run[:m]))
    assert model.compare(u, y).one_step == pytest.approx(measured.free_run, abs=0, nan_ok=True)


def test_rows_of_experiments_do_not_mix():
    u, y = furnace()
    parts = [slice(0, 100), slice(100, 180), slice(180, 296)]
    us, ys = [u[part] for part in parts], [y[part] for part in parts]
    model = cgheight.arx(us, ys, 2, 3, 3, 9.0)
    whole = regression(u, y, 2, 3, 3).model
    # Rows of the whole log without the first five of each part.
    kept = np.concatenate([np.arange(part.start, part.stop - 5) for part in parts])
    theta = np.linalg.lstsq(whole._x[kept], whole._y[kept].ravel(), rcond=None)[0]
    assert np.concatenate([-model.a[1:], model.b[3:]]) == pytest.approx(theta, rel=1e-9)
    assert model.rows == len(kept) == 281
    # The order does not matter, and one experiment in a list is that experiment.
    turned = cgheight.arx(us[::-1], ys[::-1], 2, 3, 3, 9.0)
    assert turned.a == pytest.approx(model.a, rel=1e-9)
    assert np.array_equal(
        cgheight.arx([u], [y], 2, 3, 3, 9.0).a, cgheight.arx(u, y, 2, 3, 3, 9.0).a
    )
    # One of two rows is too short for a row of the regression and adds nothing.
    more = cgheight.arx([*us, u[:2]], [*ys, y[:2]], 2, 3, 3, 9.0)
    assert (more.rows, more.dc_gain) == (model.rows, model.dc_gain)
    chosen = cgheight.select_order(us, ys, 9.0, na=(1, 2), nb=(2, 3), nk=(2, 3))
    best = chosen.model
    again = cgheight.arx(us, ys, best.na, best.nb, best.nk, 9.0)
    assert np.array_equal(best.a, again.a)


def test_experiments_that_do_not_fit_are_named():
    u, y = furnace()
    with pytest.raises(ValueError, match="experiments is 2 in u and 1 in y"):
        cgheight.arx([u, u], y, 2, 2, 1, 9.0)
    with pytest.raises(ValueError, match="experiments is 1 in u and 2 in y"):
        cgheight.arx([u], [y, y], 2, 2, 1, 9.0)
    with pytest.raises(ValueError, match=r"y\[1\] has 295 values and u\[1\] has 296"):
        cgheight.arx([u, u], [y, y[1:]], 2, 2, 1, 9.0)
    hole = y.copy()
    hole[7] = np.nan
    with pytest.raises(ValueError, match=r"y\[1\]\[7\] is NaN"):
        cgheight.arx([u, u], [y, hole], 2, 2, 1, 9.0)
    model = cgheight.arx(u, y, 2, 2, 1, 9.0)
    with pytest.raises(ValueError, match=r"y\[7\] is nan: the model needs every value"):
        model.compare(u, hole)
    with pytest.raises(ValueError, match="k is 0"):
        model.predict(u, y, 0)
    with pytest.raises(TypeError):
        model.predict(u, y, 1.5)
    with pytest.raises(ValueError, match="y is constant"):
        model.compare(u, np.ones_like(u))
    with pytest.raises(ValueError, match="start is 'zero'"):
        model.free_run(u, y, start="zero")


@pytest.mark.parametrize("order", [0, 1, 2])
def test_trends_are_removed_as_by_statsmodels(order):
    data = np.genfromtxt(FIXTURES / "arx" / "gas_furnace.csv", delimiter=",", names=True)
    signal = data["y"] + 0.01 * np.arange(296)
    expected = statsmodels_detrend(signal, order=order)
    # ε times values of 60, and times the condition number of the powers there, 1e5.
    assert cgheight.detrend(signal, order=order) == pytest.approx(expected, abs=1e-8)
    hole = signal.copy()
    hole[100:120] = np.nan
    without = cgheight.detrend(hole, order=order)
    assert np.array_equal(np.isnan(without), np.isnan(hole))
    assert abs(np.nanmean(without)) < 1e-10
    with pytest.raises(ValueError, match="order is 3: it must be 0 or more, and less than"):
        cgheight.detrend([1.0, 2.0, np.nan, 3.0], order=3)


def test_output_error_removes_the_bias_that_noise_of_the_sensor_causes():
    random, runs = np.random.default_rng(11), 60
    truth, gain = np.concatenate([A[1:], B[1:]]), float(np.sum(B) / np.sum(A))
    squares, arx_squares, gains = [], [], []
    for _ in range(runs):
        u, y = noisy(random, 1000, 0.1, "output")
        arx = cgheight.arx(u, y, 2, 2, 1, 0.05)
        refined = cgheight.output_error(u, y, arx)
        for model, into in ((refined, squares), (arx, arx_squares)):
            off = np.concatenate([model.a[1:], model.b[1:]]) - truth
            into.append(off @ np.linalg.solve(model.covariance, off))
        gains.append((refined.dc_gain - gain) / refined.dc_gain_sd)
        assert refined.noise_variance == pytest.approx(0.01, rel=5 * np.sqrt(2 / 1000))
    # The sum of chi-squares with 4 degrees of freedom each; by chance beyond with 1e-4 each way.
    low, high = scipy.stats.chi2.ppf([1e-4, 1 - 1e-4], 4 * runs)
    assert low < np.sum(squares) < high
    # Every ARX model is wrong by more than its covariance allows with a chance of 1e-12.
    assert np.min(arx_squares) > scipy.stats.chi2.ppf(1 - 1e-12, 4)
    # The mean of 60 standardized errors of the gain scatters by 1/sqrt(60), 4 sd, and the sum of
    # their squares is chi-square.
    assert abs(np.mean(gains)) < 4 / np.sqrt(runs)
    low, high = scipy.stats.chi2.ppf([1e-4, 1 - 1e-4], runs)
    assert low < np.sum(np.square(gains)) < high


def test_output_error_of_experiments_from_other_states_is_one_model():
    random = np.random.default_rng(12)
    u, y = noisy(random, 1200, 0.1, "output")
    parts = [slice(0, 300), slice(340, 700), slice(710, 1200)]
    us, ys = [u[part] for part in parts], [y[part] for part in parts]
    model = cgheight.output_error(us, ys, cgheight.arx(us, ys, 2, 2, 1, 0.05))
    off = np.concatenate([model.a[1:], model.b[1:]]) - np.concatenate([A[1:], B[1:]])
    # Chi-square with 4 degrees of freedom: above 23.5 by chance once in 1e4.
    assert off @ np.linalg.solve(model.covariance, off) < scipy.stats.chi2.ppf(1 - 1e-4, 4)
    assert model.rows == 300 + 360 + 490 - 3 * 2
    assert repr(model).startswith("OutputErrorModel([2 2 1], 0.05 s, DC gain 0.7")
    assert "fit, free run" in model._repr_html_()
    # The best starts are those that were fitted, two values for each experiment beside the four
    # coefficients.
    rest = np.concatenate([model.residuals(*data) for data in zip(us, ys, strict=True)])
    variance = rest @ rest / (model.rows - 4 - 2 * 3)
    assert variance == pytest.approx(model.noise_variance, rel=1e-9)
    # Without noise, the coefficients are exact: the search ends at relative steps of 1e-12.
    us, ys = zip(*(noisy(random, 200) for _ in range(2)), strict=True)
    rough = replace(model, a=np.array([1.0, -1.2, 0.5]), b=np.array([0.0, 0.2, 0.0]))
    exact = cgheight.output_error(us, ys, rough)
    assert exact.a == pytest.approx(A, abs=1e-9)
    assert exact.b == pytest.approx(B, abs=1e-9)


def test_output_error_of_the_gas_furnace_is_that_of_a_search_by_differences():
    u, y = furnace()
    arx = cgheight.arx(u, y, 1, 3, 3, 9.0)
    model = cgheight.output_error(u, y, arx)

    def run(_, a1, b1, b2, b3, first):
        """Simulate in the state space of python-control from a free first output."""
        drive = np.append(np.convolve(u, [0, 0, 0, b1, b2, b3])[6:296], 0.0)
        system = control.ss(-a1, 1.0, 1.0, 0.0, True)
        return control.forced_response(system, inputs=drive, initial_state=first).outputs

    theta = np.concatenate([model.a[1:], model.b[3:]])
    begin = [-0.5, -0.5, -0.3, -0.3, y[5]]
    found, covariance = scipy.optimize.curve_fit(run, None, y[5:], begin, xtol=1e-12, ftol=1e-12)
    # Differences of 1e-8 have errors of 1e-8; the condition number of the problem is below 1e4.
    assert theta == pytest.approx(found[:4], rel=1e-4)
    assert model.covariance == pytest.approx(covariance[:4, :4], rel=1e-3)
    # Box and Jenkins have (0.53 + 0.37 q + 0.51 q²) / (1 - 0.57 q) behind a delay of 3, with a
    # model of the noise: another model of the same gain, which is within 2 sd of it.
    assert abs(model.dc_gain + 1.41 / 0.43) < 2 * model.dc_gain_sd
    assert model.compare(u, y).free_run_percent > arx.compare(u, y).free_run_percent


def test_output_error_says_what_is_missing():
    u, y = furnace()
    model = cgheight.arx(u, y, 2, 2, 1, 9.0)
    with pytest.raises(ValueError, match="6 parameters; give a longer log"):
        cgheight.output_error(u[:7], y[:7], model)
    with pytest.raises(ValueError, match="unexcited"):
        cgheight.output_error(np.zeros(100), y[:100], model)
    with pytest.raises(TypeError, match="model is of type str: give an ArxModel"):
        cgheight.output_error(u, y, "arx")
    unstable = replace(model, a=np.array([1.0, -2.1, 1.2]))
    refined = cgheight.output_error(u, y, unstable)
    assert np.all(np.abs(refined.poles) < 1)
