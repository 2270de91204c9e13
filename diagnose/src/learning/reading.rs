//! A fitted curve in the words of physics: simple forms by weighted least squares to its points, the shortest that is as good as the
//! noise allows.

use counterpoise_linalg::{Mat, inverse, solve};
use counterpoise_models::{LearnedElement, RegimeVariable};

use crate::tolerance::identification::NORMAL_95;
use crate::tolerance::learning::FLAT_CURVE;
use crate::tolerance::learning::FORM_RIDGE;
use crate::tolerance::learning::{
    BAND_FLOOR, FORM_GRID, FORM_SLOPE_STEP, ORDERS_AT_MOST, READ_FROM_COVERAGE, READ_SHARE,
    SMALLEST_DEAD_BAND, SMALLEST_WIDTH,
};

/// A simple form of a curve over a variable x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurveForm {
    /// level.
    Constant,
    /// level + slope x.
    Linear,
    /// level + step sgn(x).
    Sign,
    /// level + slope x beyond a distance, 0 within it.
    DeadZone,
    /// level + slope x within a distance, constant beyond it.
    DeadBand,
    /// level + slope x + bend x^2.
    Quadratic,
    /// level + slope x + cubic x^3.
    Cubic,
    /// level + rise clamp((x - centre) / width).
    Saturation,
    /// level + rise (1 - exp(-x / constant)).
    ExponentialApproach,
    /// level + amplitude sin(order x + phase).
    Sine,
    /// level + height exp(-((x - centre) / width)^2).
    Bump,
}

/// A parameter of a form.
#[derive(Debug, Clone, PartialEq)]
pub struct FormParameter {
    /// Name.
    pub name: &'static str,
    /// Value, in the units of the curve.
    pub value: f64,
    /// Half width of its 95 % interval.
    pub half_width: f64,
}

/// Interpretation of a fitted curve: its form and its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveReading {
    /// The form.
    pub form: CurveForm,
    /// Parameters.
    pub parameters: Vec<FormParameter>,
    /// Share of the curve's variation that the form explains, 0 to 1.
    pub explained: f64,
}

impl CurveReading {
    /// Returns a parameter's value by its name; 0 if the form has none of that name.
    pub fn value(&self, name: &str) -> f64 {
        self.find(name).map_or(0.0, |p| p.value)
    }

    /// Returns the half width of a parameter's interval by its name; 0 if the form has none of that name.
    pub fn half_width(&self, name: &str) -> f64 {
        self.find(name).map_or(0.0, |p| p.half_width)
    }

    /// Returns the 95 % interval of a parameter by its name.
    pub fn interval(&self, name: &str) -> [f64; 2] {
        let (value, half) = (self.value(name), self.half_width(name));
        [value - half, value + half]
    }

    /// Returns how much a line changes over the range of its points, and the half width of that.
    pub fn change_over(&self, element: &LearnedElement) -> [f64; 2] {
        let range = element.points.last().unwrap_or(&0.0) - element.points.first().unwrap_or(&0.0);
        [(self.value("slope") * range).abs(), self.half_width("slope") * range]
    }

    fn find(&self, name: &str) -> Option<&FormParameter> {
        self.parameters.iter().find(|p| p.name == name)
    }
}

/// The points of a curve that recordings visit, with weights.
struct Curve {
    x: Vec<f64>,
    y: Vec<f64>,
    weight: Vec<f64>,
    low: f64,
    high: f64,
}

/// A form with its inner parameters at given values, fitted in the others.
pub(crate) struct FittedForm {
    pub form: CurveForm,
    /// Values of the parameters that do not enter linearly.
    pub inner: Vec<f64>,
    /// Coefficients of its terms.
    pub linear: Vec<f64>,
    deviation: Vec<f64>,
    squares: f64,
}

/// A free function with what its curve says.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadElement {
    /// The function.
    pub element: LearnedElement,
    /// The simple form that its curve has; `None` if it has none.
    pub reading: Option<CurveReading>,
}

/// Reads the free functions of a mechanism.
pub fn read_elements(elements: &[LearnedElement]) -> Vec<ReadElement> {
    elements
        .iter()
        .map(|element| ReadElement { element: element.clone(), reading: read_curve(element) })
        .collect()
}

/// Returns the simple form that a curve has; `None` if none explains most of it, or if it has too few points.
pub fn read_curve(element: &LearnedElement) -> Option<CurveReading> {
    let curve = Curve::of(element)?;
    let count = curve.x.len() as f64;
    let ranked = curve.ranked_forms(element.variable);
    let total = ranked.iter().find(|fit| fit.form == CurveForm::Constant)?.squares;
    let best = ranked.into_iter().next()?;
    let explained = if total > 0.0 { 1.0 - best.squares / total } else { 1.0 };
    let flat = best.form == CurveForm::Constant;
    let within_noise = best.squares < count;
    // a level that is not told from the one that changes nothing says nothing
    let off = (best.linear[0] - element.quantity.neutral()).abs() > NORMAL_95 * best.deviation[0];
    (if flat { within_noise && off } else { explained > READ_SHARE || within_noise }).then(|| CurveReading {
        form: best.form,
        parameters: curve.parameters(&best),
        explained,
    })
}

/// Returns the forms of a curve, that which comes nearest for its number of parameters first; none if it has too few points.
pub(crate) fn nearest_forms(element: &LearnedElement) -> Vec<FittedForm> {
    Curve::of(element).map_or_else(Vec::new, |curve| curve.ranked_forms(element.variable))
}

/// Returns a form that comes nearest to a curve; `None` if the curve has too few points.
pub(crate) fn nearest_of_form(element: &LearnedElement, form: CurveForm) -> Option<FittedForm> {
    Curve::of(element)?.fit_best_form(form)
}

impl FittedForm {
    /// Returns the values of its terms over some points, term by term.
    pub fn term_rows(&self, points: &[f64]) -> Vec<Vec<f64>> {
        let at: Vec<Vec<f64>> = points.iter().map(|x| terms(self.form, &self.inner, *x)).collect();
        (0..self.linear.len()).map(|term| at.iter().map(|row| row[term]).collect()).collect()
    }

    /// Returns what a change of a parameter that does not enter linearly changes of its values over some points, by the difference of two.
    pub fn inner_slope(&self, place: usize, points: &[f64]) -> Vec<f64> {
        let step = FORM_SLOPE_STEP * self.inner[place].abs().max(f64::MIN_POSITIVE);
        let moved = |by: f64| {
            let mut inner = self.inner.clone();
            inner[place] += by;
            Self { inner, linear: self.linear.clone(), deviation: Vec::new(), ..*self }.values(points)
        };
        moved(step).iter().zip(moved(-step)).map(|(above, below)| (above - below) / (2.0 * step)).collect()
    }

    /// Returns where it has corners.
    pub fn corners(&self) -> Vec<f64> {
        match (self.form, self.inner.as_slice()) {
            (CurveForm::DeadZone | CurveForm::DeadBand, [distance, ..]) => vec![-distance, *distance],
            (CurveForm::Saturation, [centre, width, ..]) => vec![centre - width, centre + width],
            _ => Vec::new(),
        }
    }

    /// Returns its values over some points.
    pub fn values(&self, points: &[f64]) -> Vec<f64> {
        let at =
            |x: &f64| terms(self.form, &self.inner, *x).iter().zip(&self.linear).map(|(t, c)| t * c).sum();
        points.iter().map(at).collect()
    }
}

/// Returns the forms that make sense over a variable, the shortest first.
fn forms_over(variable: RegimeVariable) -> &'static [CurveForm] {
    match variable {
        RegimeVariable::Turn => &[CurveForm::Sine, CurveForm::Bump],
        RegimeVariable::Time => {
            &[CurveForm::Linear, CurveForm::ExponentialApproach, CurveForm::Sine, CurveForm::Quadratic]
        }
        RegimeVariable::Reading => &[
            CurveForm::Linear,
            CurveForm::DeadBand,
            CurveForm::DeadZone,
            CurveForm::Quadratic,
            CurveForm::Cubic,
            CurveForm::Saturation,
            CurveForm::Sine,
            CurveForm::Bump,
        ],
        _ => &[
            CurveForm::Linear,
            CurveForm::Sign,
            CurveForm::DeadZone,
            CurveForm::Quadratic,
            CurveForm::Cubic,
            CurveForm::Saturation,
            CurveForm::Sine,
            CurveForm::Bump,
        ],
    }
}

impl Curve {
    fn of(element: &LearnedElement) -> Option<Self> {
        let visited = |k: usize| element.coverage.get(k).is_none_or(|share| *share >= READ_FROM_COVERAGE);
        let kept: Vec<usize> = (0..element.points.len()).filter(|k| visited(*k)).collect();
        let of = |list: &[f64]| kept.iter().map(|k| list[*k]).collect::<Vec<f64>>();
        let (x, y) = (of(&element.points), of(&element.values));
        if x.len() < 5 {
            return None;
        }
        let low_high = |list: &[f64]| {
            list.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)))
        };
        let (bottom, top) = low_high(&y);
        let floor =
            BAND_FLOOR * (top - bottom).max(FLAT_CURVE * top.abs().max(bottom.abs())).max(f64::MIN_POSITIVE);
        let weight = |k: &usize| {
            let half = element.half_width.get(*k).copied().unwrap_or(0.0);
            (half / NORMAL_95).max(floor).powi(-2)
        };
        let (low, high) = low_high(&x);
        Some(Self { weight: kept.iter().map(weight).collect(), x, y, low, high })
    }

    /// Returns the forms that make sense over a variable, the best for its number of parameters first.
    fn ranked_forms(&self, variable: RegimeVariable) -> Vec<FittedForm> {
        let count = self.x.len() as f64;
        // Schwarz 1978, of a curve whose own deviation is one: what is below the noise counts as noise
        let price = |fit: &FittedForm| {
            let size = fit.inner.len() + fit.linear.len();
            count * (1.0 + fit.squares / count).ln() + size as f64 * count.ln()
        };
        let forms = forms_over(variable).iter().chain([&CurveForm::Constant]);
        let mut ranked: Vec<FittedForm> = forms.filter_map(|form| self.fit_best_form(*form)).collect();
        ranked.sort_by(|a, b| price(a).total_cmp(&price(b)));
        ranked
    }

    /// Returns a form fitted to the curve: its inner parameters by a grid that is refined twice, the others by least squares.
    fn fit_best_form(&self, form: CurveForm) -> Option<FittedForm> {
        // a dead band may be of any size: its grid is even in the logarithm
        let is_log = form == CurveForm::DeadBand;
        let to = |x: f64| if is_log { x.ln() } else { x };
        let back = |x: f64| if is_log { x.exp() } else { x };
        let ranges = self.inner_ranges(form).into_iter();
        let mut grids: Vec<[f64; 2]> = ranges.map(|range| range.map(to)).collect();
        let mut best: Option<FittedForm> = None;
        for _ in 0..if grids.is_empty() { 1 } else { 3 } {
            for inner in points_of(&grids) {
                let found = self.fit_form(form, inner.into_iter().map(back).collect());
                best = match (best, found) {
                    (Some(old), Some(new)) if old.squares <= new.squares => Some(old),
                    (old, new) => new.or(old),
                };
            }
            let at = &best.as_ref()?.inner;
            for (grid, value) in grids.iter_mut().zip(at.iter().map(|value| to(*value))) {
                let reach = 1.5 * (grid[1] - grid[0]) / FORM_GRID as f64;
                *grid = [(value - reach).max(grid[0]), (value + reach).min(grid[1])];
            }
        }
        best
    }

    /// Returns the ranges of the parameters that do not enter linearly.
    fn inner_ranges(&self, form: CurveForm) -> Vec<[f64; 2]> {
        let range = self.high - self.low;
        let widths = [SMALLEST_WIDTH * range, range];
        let reach = self.low.abs().max(self.high.abs());
        match form {
            CurveForm::Constant
            | CurveForm::Linear
            | CurveForm::Sign
            | CurveForm::Quadratic
            | CurveForm::Cubic => Vec::new(),
            CurveForm::DeadZone => vec![[0.02 * reach, 0.9 * reach]],
            CurveForm::DeadBand => vec![[SMALLEST_DEAD_BAND * reach, 0.9 * reach]],
            CurveForm::Saturation | CurveForm::Bump => vec![[self.low, self.high], widths],
            CurveForm::ExponentialApproach => vec![widths],
            CurveForm::Sine => vec![[std::f64::consts::TAU * 0.75 / range, self.fastest_sine()]],
        }
    }

    /// Returns the fastest sine that the points can show.
    fn fastest_sine(&self) -> f64 {
        let spacing = (self.high - self.low) / (self.x.len() - 1) as f64;
        (std::f64::consts::PI / spacing * 0.8)
            .min(ORDERS_AT_MOST / (self.high - self.low) * std::f64::consts::TAU)
    }

    fn fit_form(&self, form: CurveForm, inner: Vec<f64>) -> Option<FittedForm> {
        let rows: Vec<Vec<f64>> = self.x.iter().map(|x| terms(form, &inner, *x)).collect();
        let count = rows[0].len();
        let sum = |of: &dyn Fn(usize) -> f64| (0..self.x.len()).map(|k| self.weight[k] * of(k)).sum::<f64>();
        let mut normal = Mat::from_fn(count, count, |i, j| sum(&|k| rows[k][i] * rows[k][j]));
        for i in 0..count {
            normal[(i, i)] *= 1.0 + FORM_RIDGE;
        }
        let right: Vec<f64> = (0..count).map(|i| sum(&|k| rows[k][i] * self.y[k])).collect();
        let linear = solve(&normal, &Mat::col(&right)).ok().filter(Mat::is_finite)?.as_slice().to_vec();
        let missed = |k: usize| self.y[k] - rows[k].iter().zip(&linear).map(|(r, c)| r * c).sum::<f64>();
        let squares = sum(&|k| missed(k).powi(2));
        let free = self.x.len().saturating_sub(count + inner.len()).max(1) as f64;
        let scale = (squares / free).max(1.0).sqrt();
        let covariance = inverse(&normal).ok()?;
        let deviation = (0..count).map(|i| scale * covariance[(i, i)].max(0.0).sqrt()).collect();
        Some(FittedForm { form, inner, linear, deviation, squares })
    }

    /// Returns half the width of the 95 % interval of an inner parameter: where the sum of squares has grown by what noise allows.
    fn inner_half_width(&self, best: &FittedForm, place: usize) -> f64 {
        let range = self.inner_ranges(best.form)[place];
        let free = self.x.len().saturating_sub(best.linear.len() + best.inner.len()).max(1) as f64;
        let allowed = best.squares + NORMAL_95.powi(2) * (best.squares / free).max(1.0);
        let worse = |by: f64| {
            let mut inner = best.inner.clone();
            inner[place] += by;
            self.fit_form(best.form, inner).is_none_or(|fit| fit.squares > allowed)
        };
        let mut half = 1e-4 * (range[1] - range[0]);
        while half < range[1] - range[0] && !(worse(half) || best.inner[place] > half && worse(-half)) {
            half *= 1.25;
        }
        half
    }

    fn parameters(&self, best: &FittedForm) -> Vec<FormParameter> {
        let linear = |name, k: usize| FormParameter {
            name,
            value: best.linear[k],
            half_width: 1.96 * best.deviation[k],
        };
        let inner = |name, k: usize| FormParameter {
            name,
            value: best.inner[k],
            half_width: self.inner_half_width(best, k),
        };
        let level = linear("level", 0);
        match best.form {
            CurveForm::Constant => vec![level],
            CurveForm::Linear => vec![level, linear("slope", 1)],
            CurveForm::Sign => vec![level, linear("step", 1)],
            CurveForm::DeadZone | CurveForm::DeadBand => {
                vec![level, linear("slope", 1), inner("distance", 0)]
            }
            CurveForm::Quadratic => vec![level, linear("slope", 1), linear("bend", 2)],
            CurveForm::Cubic => vec![level, linear("slope", 1), linear("cubic", 2)],
            CurveForm::Saturation => vec![level, linear("rise", 1), inner("centre", 0), inner("width", 1)],
            CurveForm::ExponentialApproach => vec![level, linear("rise", 1), inner("constant", 0)],
            CurveForm::Bump => vec![level, linear("height", 1), inner("centre", 0), inner("width", 1)],
            CurveForm::Sine => {
                let (sin, cos) = (best.linear[1], best.linear[2]);
                let half_width = 1.96 * best.deviation[1].max(best.deviation[2]);
                let amplitude = FormParameter { name: "amplitude", value: sin.hypot(cos), half_width };
                let doubt = (half_width / sin.hypot(cos).max(f64::MIN_POSITIVE)).min(std::f64::consts::PI);
                let phase = FormParameter { name: "phase", value: cos.atan2(sin), half_width: doubt };
                vec![level, amplitude, inner("order", 0), phase]
            }
        }
    }
}

/// Returns the terms of a form at a point, which enter it linearly.
fn terms(form: CurveForm, inner: &[f64], x: f64) -> Vec<f64> {
    match form {
        CurveForm::Constant => vec![1.0],
        CurveForm::Linear => vec![1.0, x],
        CurveForm::Sign => vec![1.0, if x == 0.0 { 0.0 } else { x.signum() }],
        CurveForm::DeadZone => vec![1.0, (x.abs() - inner[0]).max(0.0) * x.signum()],
        CurveForm::DeadBand => vec![1.0, x.clamp(-inner[0], inner[0])],
        CurveForm::Quadratic => vec![1.0, x, x * x],
        CurveForm::Cubic => vec![1.0, x, x * x * x],
        CurveForm::Saturation => vec![1.0, ((x - inner[0]) / inner[1]).clamp(-1.0, 1.0)],
        CurveForm::ExponentialApproach => vec![1.0, 1.0 - (-x / inner[0]).exp()],
        CurveForm::Sine => vec![1.0, (inner[0] * x).sin(), (inner[0] * x).cos()],
        CurveForm::Bump => vec![1.0, (-((x - inner[0]) / inner[1]).powi(2)).exp()],
    }
}

/// Returns the points of a grid over some ranges; one without parameters if there are none.
fn points_of(ranges: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let mut all = vec![Vec::new()];
    for [low, high] in ranges {
        let at = |k: usize| low + (high - low) * k as f64 / (FORM_GRID - 1) as f64;
        let with = |point: &Vec<f64>, k: usize| point.iter().copied().chain([at(k)]).collect::<Vec<f64>>();
        all =
            all.iter().flat_map(|point| (0..FORM_GRID).map(|k| with(point, k)).collect::<Vec<_>>()).collect();
    }
    all
}
