//! ARX least squares in the classical shift form (eqs. 5.1, 5.2).

use crate::identify::identifier::{Answer, Fit, Identify, Moments, Unexcited};
use crate::identify::mean::Mean;
use crate::identify::pending::{LONG_BLOCK, Pending};
use crate::math::linalg::Triangle;
use crate::math::real::Real;
use crate::truck::ratio::Measured;
use crate::truck::reduced::Reduced5;
use crate::truck::simulation::Simulation;

/// ARX `[na nb nk]` in the classical shift form (eq. 5.1):
///
/// ```text
///     y(t) + a1 y(t−1) + … = b1 u(t−nk) + … + b_nb u(t−nk−nb+1) + e(t)
/// ```
///
/// `na` is the number of past outputs, `nb` the number of input terms, and `nk` the number of
/// samples until the input first acts. The unknowns are `a1 … a_na, b1 … b_nb`; `N` is their
/// greatest number, so `na + nb ≤ N`.
///
/// ```
/// use cg_core::{Answer, Arx};
///
/// let mut arx = Arx::<f64, 2>::new(1, 1, 1).unwrap();
/// let (mut y, mut u) = (0.0, 0.0);
/// for k in 0..20 {
///     arx.push(u, y, true);
///     y = 0.8 * y + 0.5 * u;
///     u = if k % 3 == 0 { 1.0 } else { -0.4 };
/// }
/// let Answer::Ready(fit) = arx.fit() else { panic!("well excited") };
/// assert!((fit.ratio.value - 2.5).abs() < 1e-10); // 0.5 / (1 − 0.8)
/// ```
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize, [T; N]: serde::Serialize, [[T; N]; N]: serde::Serialize, [[T; LONG_BLOCK]; N]: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>, [T; N]: serde::Deserialize<'de>, [[T; N]; N]: serde::Deserialize<'de>, [[T; LONG_BLOCK]; N]: serde::Deserialize<'de>"
    ))
)]
pub struct Arx<T, const N: usize> {
    na: usize,
    nb: usize,
    nk: usize,
    with_constant: bool,
    past_y: [T; N],
    past_u: [T; N],
    seen: usize,
    triangle: Triangle<T, N>,
    pending: Pending<T, N, LONG_BLOCK>,
    moments: Moments<T>,
}

impl<T: Real, const N: usize> Arx<T, N> {
    /// A new identifier; `None` unless `1 ≤ nb`, `na + nb ≤ N` and `nk + nb ≤ N + 1` (the number of
    /// past inputs that are stored).
    pub fn new(na: usize, nb: usize, nk: usize) -> Option<Self> {
        let fits = nb >= 1 && na.checked_add(nb)? <= N && nk.checked_add(nb)? <= N + 1;
        fits.then(|| Self { na, nb, nk, ..Self::empty() })
    }

    const fn empty() -> Self {
        Self {
            na: 0,
            nb: 1,
            nk: 0,
            with_constant: false,
            past_y: [T::ZERO; N],
            past_u: [T::ZERO; N],
            seen: 0,
            triangle: Triangle::new(),
            pending: Pending::new(),
            moments: Moments::new(),
        }
    }

    /// The same with a constant as an additional unknown (an offset of input or output); `None` if
    /// `N` is too small for it.
    #[must_use]
    pub fn with_constant(mut self) -> Option<Self> {
        self.with_constant = true;
        (self.unknowns() <= N).then_some(self)
    }

    /// Adds one sample of input and output; samples are equally spaced in time. Its row is used for
    /// the fit only if `use_row` is true.
    pub fn push(&mut self, input: T, output: T, use_row: bool) {
        if self.seen < self.na.max(self.nb + self.nk - 1) {
            self.seen += 1;
        } else if use_row {
            let row = self.row(input);
            let row = row.get(..self.unknowns()).unwrap_or(&row);
            self.pending.push_first_into(&mut self.triangle, row, output);
            self.moments.push(input, output);
        }
        remember(&mut self.past_y, output);
        remember(&mut self.past_u, input);
    }

    /// The regressors of a sample; those beyond the unknowns are zero.
    #[inline]
    fn row(&self, input: T) -> [T; N] {
        let mut row = [T::zero(); N];
        for (x, y) in row.iter_mut().zip(&self.past_y).take(self.na) {
            *x = -*y;
        }
        let own = row.get_mut(self.na..).unwrap_or(&mut []);
        for (lag, x) in (self.nk..).zip(own.iter_mut().take(self.nb)) {
            // u(t − lag); past_u[0] is u(t−1)
            let past = lag.checked_sub(1).and_then(|i| self.past_u.get(i));
            *x = past.copied().unwrap_or(input);
        }
        if let Some(x) = own.get_mut(self.nb).filter(|_| self.with_constant) {
            *x = T::one();
        }
        row
    }

    /// Deletes the past samples but keeps the rows. Call it at a gap in the log.
    pub fn restart(&mut self) {
        self.seen = 0;
    }

    /// The least-squares solution.
    pub fn fit(&self) -> Answer<T> {
        let unknowns = self.unknowns();
        let rows = self.moments.rows;
        if rows as usize <= unknowns {
            return Answer::Unexcited(Unexcited::TooFewRows { rows });
        }
        let triangle = self.settled();
        let theta = match triangle.solve(unknowns) {
            Ok(theta) => theta,
            Err(unknown) => return Answer::Unexcited(Unexcited::Direction { unknown }),
        };
        #[allow(clippy::cast_possible_truncation)] // more rows than unknowns: it fits
        let freedom = T::of(f64::from(rows - unknowns as u32));
        let variance = triangle.sum_of_squares_at(&theta) / freedom;
        let (mut denominator, mut numerator) = (T::one(), T::zero());
        for k in 0..N {
            if k < self.na {
                denominator += theta[k];
            } else if k < self.na + self.nb {
                numerator += theta[k];
            }
        }
        let ratio = numerator / denominator;
        let mut gradient = [T::zero(); N];
        for k in 0..N {
            if k < self.na {
                gradient[k] = -ratio / denominator;
            } else if k < self.na + self.nb {
                gradient[k] = T::one() / denominator;
            }
        }
        let ratio_sd = (variance * triangle.variance_of(&gradient, unknowns)).root();
        let (snr_db, fit_percent) = self.moments.quality(variance, T::one(), T::zero());
        Answer::Ready(Fit {
            ratio: Measured { value: ratio, sd: ratio_sd },
            drift_radps: Measured::exact(T::zero()),
            bend: Measured::exact(T::zero()),
            noise_sd_rad: variance.root(),
            snr_db,
            fit_percent,
            misfit: T::zero(),
            rows,
        })
    }

    /// Covariance of the coefficients, for the noise that [`fit`](Self::fit) returns; `None` if the
    /// data do not determine them.
    pub fn covariance(&self) -> Option<[[T; N]; N]> {
        let Answer::Ready(fit) = self.fit() else { return None };
        let mut covariance = self.settled().covariance(self.unknowns());
        for entry in covariance.iter_mut().flatten() {
            *entry *= fit.noise_sd_rad * fit.noise_sd_rad;
        }
        Some(covariance)
    }

    /// The coefficients `a1 … a_na, b1 … b_nb` (and the constant); `None` if the data do not
    /// determine them.
    pub fn coefficients(&self) -> Option<[T; N]> {
        self.settled().solve(self.unknowns()).ok()
    }

    /// The triangle of all rows.
    fn settled(&self) -> Triangle<T, N> {
        let (mut triangle, mut pending) = (self.triangle, self.pending);
        pending.fold_into(&mut triangle);
        triangle
    }

    fn unknowns(&self) -> usize {
        self.na + self.nb + usize::from(self.with_constant)
    }
}

/// Puts the newest value before the past ones, and drops the oldest.
#[inline]
fn remember<T: Copy, const N: usize>(past: &mut [T; N], mut newest: T) {
    for place in past {
        core::mem::swap(place, &mut newest);
    }
}

/// Greatest number of steps of the reduced model between two samples: half a second at 200 Hz.
const MOST_STEPS: u32 = 100;

/// Settings of [`SampledArx`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ArxOptions<T> {
    /// Model order, with `na = nb = order` and `nk = 1`; at most [`SampledArx::GREATEST_ORDER`].
    pub order: usize,
    /// Sampling interval of the identification in seconds. Faster logs are downsampled.
    pub interval_s: T,
}

/// [`Arx`] with a constant as an identifier of the estimator. It downsamples the log to the
/// interval of the identification.
///
/// It is meant for comparison with the thesis. Its DC ratio has a bias that does not decrease with
/// more data and that grows with the sampling rate. Prefer [`FilteredArx`](crate::FilteredArx).
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SampledArx<T: Real> {
    arx: Arx<T, 21>,
    model: Option<Simulation<T>>,
    interval_s: T,
    elapsed_s: T,
    origin: Option<(T, T)>,
}

impl<T: Real> SampledArx<T> {
    /// The greatest order that is possible.
    pub const GREATEST_ORDER: usize = 10;
}

impl<T: Real> Identify<T> for SampledArx<T> {
    type Options = ArxOptions<T>;
    type Work = ();

    const NOT_BEGUN: () = ();
    const MOST_TOGETHER: u32 = 1;
    const EMPTY: Self = Self {
        arx: Arx::empty(),
        model: None,
        interval_s: T::ZERO,
        elapsed_s: T::ZERO,
        origin: None,
    };

    fn make_for(&mut self, model: &Reduced5<T>, _lags: bool, options: ArxOptions<T>) {
        let order = options.order.clamp(1, Self::GREATEST_ORDER);
        *self = Self {
            arx: Arx { na: order, nb: order, nk: 1, with_constant: true, ..Arx::empty() },
            model: Some(Simulation::new(&model.at_unit_gain(), options.interval_s, T::zero())),
            interval_s: options.interval_s,
            ..Self::EMPTY
        };
    }

    fn push_mean(&mut self, mean: &Mean<T>) {
        let Mean { input, roll_rad, elapsed_s, is_used, .. } = *mean;
        self.elapsed_s += elapsed_s;
        let first = self.origin.is_none();
        let (input_0, roll_0) = *self.origin.get_or_insert((input, roll_rad));
        // A tolerance of half a percent of the interval allows for rounded time stamps.
        if first || self.elapsed_s >= self.interval_s * T::of(0.995) {
            self.arx.push(input - input_0, roll_rad - roll_0, is_used);
            if let Some(model) = &mut self.model {
                if first {
                    model.rest(input);
                }
                // In a log that is slower than the identification, one sample is several steps of
                // the model.
                for _ in 0..MOST_STEPS {
                    if self.elapsed_s < self.interval_s * T::of(0.5) {
                        break;
                    }
                    model.push(input);
                    self.elapsed_s -= self.interval_s;
                }
            }
            self.elapsed_s = T::zero();
        }
    }

    fn expected_roll_rad(&self) -> T {
        self.model.as_ref().map_or(T::zero(), Simulation::roll_rad)
    }

    fn clear(&mut self) {
        (self.arx.triangle, self.arx.pending) = (Triangle::new(), Pending::new());
        self.arx.moments = Moments::new();
    }

    fn restart(&mut self) {
        self.arx.seen = 0;
        self.elapsed_s = T::zero();
        self.origin = None;
    }

    fn forget(&mut self, factor: T) {
        self.arx.pending.fold_into(&mut self.arx.triangle);
        self.arx.triangle.scale(factor.root());
        self.arx.moments.scale(factor);
    }

    fn fit_stage(&mut self, (): &mut ()) -> Option<Answer<T>> {
        Some(self.arx.fit())
    }
}
