//! The cost of the assembled loop, all parts acting together, and its slope in the gain of each part.
//!
//! Each source of disturbance is weighed by its own part's weights, as the parts are designed: the feedback's noises by the
//! feedback's, heave by the heave feedforward's, pitch by the pitch feedforward's. In the assembled loop the control of
//! *every* part acts on each source, so the cost differs from the parts' own costs, and a part's gain of 1 need not be the
//! best one. The figures are integrals of spectra,
//!
//! ```text
//!     J = 1/pi  integral over w > 0 of |H_q y|^2 + |H_r u|^2
//! ```
//!
//! by the trapezoidal rule on a logarithmic grid that is refined at every pole of the loop; no realisation of a weighted
//! control is needed, so weights that rise without bound are taken as they are.

use counterpoise_linalg::sparse::VectorEntry;
use counterpoise_linalg::{C64, CMat};
use counterpoise_lti::response::Response;
use counterpoise_lti::{StateSpace, poles};

use crate::feedforward::with_derivatives;
use crate::finding::Part;
use crate::tolerance::{GAIN_STEP, NARROWEST_POLE, POLE_AT_ZERO_RAD_S, RESONANT_DAMPING};
use crate::{Assembly, Design, DisturbanceChannel, DisturbanceKnowledge, Error, FeedforwardWeights, Weight};

/// The cost of one source of disturbance in the assembled loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SourceCost {
    /// The part whose weights and disturbances are meant.
    pub part: Part,
    /// Mean square of its weighted signals in the assembled loop.
    pub cost: f64,
    /// Relative change of the total cost for a relative change of this part's gain: negative if a larger gain would lower
    /// the total.
    pub slope: f64,
    /// The gain of this part that makes the total smallest, the others kept; `None` for the feedback, in whose gain the
    /// total is not quadratic.
    pub best_gain: Option<f64>,
    /// By what share of itself that gain lowers the total.
    pub gained: Option<f64>,
}

/// The total cost with its sources.
#[derive(Debug, Clone, PartialEq)]
pub struct TotalCost {
    /// The sum.
    pub total: f64,
    /// Feedback first.
    pub sources: Vec<SourceCost>,
}

/// Decades below and above the poles of the loop that the integrals reach.
const DECADES_BEYOND: f64 = 3.0;
/// Points of the grid per decade.
const PER_DECADE: usize = 240;
/// Points that each lightly damped pole adds, within so many half widths of it.
const AROUND_POLE: i32 = 24;
const HALF_WIDTHS: f64 = 30.0;

/// Returns the cost of the assembled loop and its slope in the gain of each part.
///
/// # Errors
/// Those of the responses.
pub fn total_cost(design: &Design) -> Result<TotalCost, Error> {
    let assembled = CostResponses::new(design)?;
    let rates = assembled.rates(design)?;
    let of_feedback = |gain: f64| assembled.feedback_source(design, &rates, gain);
    let mut channels = Vec::new();
    for channel in [DisturbanceChannel::Heave, DisturbanceChannel::Pitch] {
        if let Some(source) = ChannelSource::new(design, channel)? {
            channels.push((channel, source));
        }
    }
    let sum_at = |gain: f64| -> Result<f64, Error> {
        let mut sum = of_feedback(gain)?;
        for (_, source) in &channels {
            sum += assembled.quadratic(source, &rates, gain)?.at(1.0);
        }
        Ok(sum)
    };
    let own = of_feedback(1.0)?;
    let mut quadratics = Vec::new();
    for (channel, source) in &channels {
        quadratics.push((*channel, assembled.quadratic(source, &rates, 1.0)?));
    }
    let total = own + quadratics.iter().map(|(_, cost)| cost.at(1.0)).sum::<f64>();
    let slope = (sum_at(1.0 + GAIN_STEP)? - sum_at(1.0 - GAIN_STEP)?) / (2.0 * GAIN_STEP * total);
    let mut sources =
        vec![SourceCost { part: Part::Feedback, cost: own, slope, best_gain: None, gained: None }];
    sources.extend(quadratics.iter().map(|(channel, cost)| SourceCost {
        part: (*channel).into(),
        cost: cost.at(1.0),
        slope: (cost.linear + 2.0 * cost.square) / total,
        best_gain: Some(-0.5 * cost.linear / cost.square),
        gained: Some((cost.at(1.0) - cost.at(-0.5 * cost.linear / cost.square)) / total),
    }));
    Ok(TotalCost { total, sources })
}

/// A cost over the gain of a feedforward: constant + linear g + square g^2.
#[derive(Debug, Clone, Copy, Default)]
struct Quadratic {
    constant: f64,
    linear: f64,
    square: f64,
}

impl Quadratic {
    fn at(&self, gain: f64) -> f64 {
        self.constant + gain * (self.linear + gain * self.square)
    }

    /// Adds |before + g by|^2.
    fn add(&mut self, before: C64, by: C64, share: f64) {
        self.constant += share * before.norm_sqr();
        self.linear += share * 2.0 * (before.conj() * by).re;
        self.square += share * by.norm_sqr();
    }
}

/// A point of an integral: frequency, its share of the integral, and the factor on the feedback's gain.
#[derive(Clone, Copy)]
struct Point {
    rate: f64,
    share: f64,
    gain: f64,
}

/// The signals that a source moves without control: the hub's rate and the rate that is weighed.
#[derive(Clone, Copy)]
struct OpenLoopRates {
    hub: C64,
    weighed: C64,
}

/// The loop's responses that every source needs.
struct CostResponses {
    /// Design plant behind its delay, from every input to every true output.
    plant: Response,
    control: usize,
    rate: usize,
    hub_sensor: Option<Response>,
    /// Feedback from the measured rate to the control.
    feedback: Response,
    assembly: Assembly,
    poles: Vec<C64>,
}

/// A disturbance that a feedforward measures.
struct ChannelSource {
    generator: Response,
    sensor: Option<Response>,
    module: Response,
    columns: Vec<usize>,
    weights: FeedforwardWeights,
    rate: usize,
    poles: Vec<C64>,
}

fn scalar(response: Option<&Response>, rate: f64) -> Result<C64, Error> {
    match response {
        Some(response) => Ok(response.at(rate)?[(0, 0)]),
        None => Ok(C64::ONE),
    }
}

fn response_of(system: Option<&StateSpace>) -> Result<Option<Response>, Error> {
    Ok(system.map(Response::of).transpose()?)
}

impl ChannelSource {
    fn new(design: &Design, channel: DisturbanceChannel) -> Result<Option<Self>, Error> {
        let (Some(part), Some(weights)) = (design.part(channel), design.specification.feedforward(channel))
        else {
            return Ok(None);
        };
        let columns = design.plant.columns(channel).to_vec();
        let generator = with_derivatives(&weights.generator.realise()?, columns.len())?;
        let exact = weights.knowledge == DisturbanceKnowledge::Exact;
        let sensor = design.plant.sensor(channel).filter(|_| !exact);
        let mut all = poles(&generator)?;
        all.extend(poles(&part.module)?);
        Ok(Some(Self {
            generator: Response::of(&generator)?,
            sensor: response_of(sensor)?,
            module: Response::of(&part.module)?,
            columns,
            weights: weights.clone(),
            rate: weights.output.unwrap_or(design.plant.rate),
            poles: all,
        }))
    }

    /// The module's (control, expected rate) for a unit of the generator's white noise.
    fn module_for(&self, disturbance: &CMat, rate: f64) -> Result<[C64; 2], Error> {
        let module = self.module.at(rate)?;
        let sensor = scalar(self.sensor.as_ref(), rate)?;
        let row = |i: usize| (0..module.ncols()).map(|j| module[(i, j)] * disturbance[(j, 0)] * sensor).sum();
        Ok([row(0), row(1)])
    }
}

impl CostResponses {
    fn new(design: &Design) -> Result<Self, Error> {
        let (system, feedback) =
            (design.plant.delayed_plant()?, design.feedback_controller().select(&[0], &[1]));
        let mut all = poles(&system)?;
        all.extend(poles(&feedback)?);
        all.extend(&design.feedback.closed_loop);
        Ok(Self {
            plant: Response::of(&system)?,
            control: design.plant.control,
            rate: design.plant.rate,
            hub_sensor: response_of(design.plant.hub_sensor.as_ref())?,
            feedback: Response::of(&feedback)?,
            assembly: design.specification.assembly,
            poles: all,
        })
    }

    /// The grid: logarithmic from below the slowest to above the fastest pole, and dense around lightly damped ones.
    fn rates(&self, design: &Design) -> Result<Vec<f64>, Error> {
        let mut all = self.poles.clone();
        for channel in [DisturbanceChannel::Heave, DisturbanceChannel::Pitch] {
            all.extend(ChannelSource::new(design, channel)?.into_iter().flat_map(|source| source.poles));
        }
        let moduli = all.iter().map(|pole| pole.norm()).filter(|modulus| *modulus > POLE_AT_ZERO_RAD_S);
        let (low, high) = moduli.fold((f64::INFINITY, 0.0_f64), |(a, b), m| (a.min(m), b.max(m)));
        if high == 0.0 {
            return Ok(Vec::new());
        }
        let (low, high) = (low * 10f64.powf(-DECADES_BEYOND), high * 10f64.powf(DECADES_BEYOND));
        let count = ((high / low).log10() * PER_DECADE as f64).ceil() as usize;
        let mut rates: Vec<f64> =
            (0..=count).map(|k| low * (high / low).powf(k as f64 / count as f64)).collect();
        for pole in all.iter().filter(|pole| pole.im > 0.0 && pole.re.abs() < RESONANT_DAMPING * pole.norm())
        {
            let width = pole.re.abs().max(NARROWEST_POLE * pole.norm());
            let offsets = (-AROUND_POLE..=AROUND_POLE).map(|k| {
                let share = f64::from(k) / f64::from(AROUND_POLE);
                share.powi(3) * HALF_WIDTHS * width
            });
            // On an undamped pole of the plant itself no response exists; that of the loop does to either side.
            let is_undamped = pole.re.abs() <= f64::EPSILON * pole.norm();
            let apart = offsets.filter(|offset| *offset != 0.0 || !is_undamped);
            rates.extend(apart.map(|offset| pole.im + offset).filter(|rate| *rate > low));
        }
        rates.sort_by(f64::total_cmp);
        rates.dedup();
        Ok(rates)
    }

    /// Sums a density over the grid: the density at each rate with the rate's share of the integral.
    fn integrate(rates: &[f64], mut add: impl FnMut(f64, f64) -> Result<(), Error>) -> Result<(), Error> {
        for (k, &rate) in rates.iter().enumerate() {
            let below = if k > 0 { rates[k - 1] } else { 0.0 };
            let above = rates.get(k + 1).copied().unwrap_or(rate);
            add(rate, 0.5 * (above - below) / std::f64::consts::PI)?;
        }
        Ok(())
    }

    /// The cost of a channel's disturbance and its sensor's noise over the gain of its feedforward, the feedback's gain
    /// times `feedback_gain`.
    fn quadratic(
        &self,
        source: &ChannelSource,
        rates: &[f64],
        feedback_gain: f64,
    ) -> Result<Quadratic, Error> {
        let mut cost = Quadratic::default();
        Self::integrate(rates, |rate, share| {
            let disturbance = source.generator.at(rate)?;
            let plant = self.plant.at(rate)?;
            let direct = |output: usize| -> C64 {
                source
                    .columns
                    .iter()
                    .enumerate()
                    .map(|(j, &c)| plant[(output, c)] * disturbance[(j, 0)])
                    .sum()
            };
            let module = source.module_for(&disturbance, rate)?;
            let given = OpenLoopRates { hub: direct(self.rate), weighed: direct(source.rate) };
            let at = Point { rate, share, gain: feedback_gain };
            self.add(&mut cost, source, at, &plant, given, module)?;
            if let DisturbanceKnowledge::Measured { noise } = source.weights.knowledge {
                let of_noise = source.module.at(rate)?;
                let module = [of_noise[(0, 0)], of_noise[(1, 0)]].map(|value| value * noise.sqrt());
                let none = OpenLoopRates { hub: C64::ZERO, weighed: C64::ZERO };
                self.add(&mut cost, source, at, &plant, none, module)?;
            }
            Ok(())
        })?;
        Ok(cost)
    }

    /// Adds a source that moves the (hub, weighted) rates by `given` and makes the module say `module`.
    fn add(
        &self,
        cost: &mut Quadratic,
        source: &ChannelSource,
        Point { rate, share, gain }: Point,
        plant: &CMat,
        given: OpenLoopRates,
        module: [C64; 2],
    ) -> Result<(), Error> {
        let H = scalar(self.hub_sensor.as_ref(), rate)?;
        let K = self.feedback.at(rate)?[(0, 0)] * gain;
        let G = plant[(self.rate, self.control)];
        let closed = C64::ONE / (C64::ONE - K * H * G);
        let expected = match self.assembly {
            Assembly::SimpleAdd | Assembly::Joint => C64::ZERO,
            Assembly::Grimble => H * module[1],
        };
        let before = closed * K * H * given.hub;
        let by = closed * (module[0] - K * expected);
        let to_weighed = plant[(source.rate, self.control)];
        let error = source.weights.error.response(rate);
        let control = source.weights.control.response(rate);
        cost.add(error * (given.weighed + to_weighed * before), error * to_weighed * by, share);
        cost.add(control * before, control * by, share);
        Ok(())
    }

    /// The cost of what no sensor announces under the feedback's weights, the feedback's gain times `gain`.
    fn feedback_source(&self, design: &Design, rates: &[f64], gain: f64) -> Result<f64, Error> {
        let weights = &design.specification.feedback;
        let direct = direct_part(&weights.error)?;
        let mut sum = 0.0;
        Self::integrate(rates, |rate, share| {
            let plant = self.plant.at(rate)?;
            let (H, K) = (scalar(self.hub_sensor.as_ref(), rate)?, self.feedback.at(rate)?[(0, 0)] * gain);
            let closed = C64::ONE / (C64::ONE - K * H * plant[(self.rate, self.control)]);
            let (error, control) = (weights.error.response(rate), weights.control.response(rate));
            let mut inputs = vec![VectorEntry::new(self.control, weights.loop_recovery)];
            inputs.extend(&weights.disturbances);
            for VectorEntry { index: input, value: density } in
                inputs.into_iter().filter(|one| one.value > 0.0)
            {
                let u = closed * K * H * plant[(self.rate, input)];
                let at = |output: usize| plant[(output, input)] + plant[(output, self.control)] * u;
                let further: C64 =
                    weights.combination.iter().map(|entry| at(entry.index) * entry.value).sum();
                let all =
                    (error * H * at(self.rate)).norm_sqr() + (control * u).norm_sqr() + further.norm_sqr();
                sum += share * density * all;
            }
            let u = closed * K;
            let at = |output: usize| plant[(output, self.control)] * u;
            let further: C64 = weights.combination.iter().map(|entry| at(entry.index) * entry.value).sum();
            let noisy = error * H * at(self.rate) + (error - direct);
            let all = noisy.norm_sqr() + (control * u).norm_sqr() + further.norm_sqr();
            sum += share * weights.measurement_noise * all;
            Ok(())
        })?;
        Ok(sum)
    }
}

/// The direct part of an error weight, which sees no noise.
fn direct_part(weight: &Weight) -> Result<f64, Error> {
    let mirrored = weight.realise()?;
    let sign = weight.rational().gain.signum();
    Ok(sign * mirrored.D[(0, 0)])
}
