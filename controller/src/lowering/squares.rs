//! The estimator's recursive least squares in a step.

use crate::lowering::regressors::{EstimatorInputs, regressors, write_unexplained};
use crate::lowering::{Limits, States, Writer};
use crate::program::{OnRestart, Slot, StateLimits};
use crate::tolerance::{LEAST_VARIANCE, MOST_TOLD, MOST_VARIANCE, WHOLE, WOUND_END, WOUND_START};
use crate::{Estimator, Learning, PathSignal};

/// Recursive least squares with the covariance as U D U'.
pub(crate) fn squares(
    inputs: &EstimatorInputs<'_>,
    estimator: &Estimator,
    states: &mut States,
    writer: &mut Writer,
) {
    let Learning::Squares { forget, dead_band_m_s2, deviation, filter_s, inertia_v_s2_rad } =
        &estimator.learning
    else {
        return;
    };
    let p = inputs.layout.estimate.clone();
    let n = p.len();
    let mut phi = regressors(inputs, estimator, writer).to_vec();
    let mut control = inputs.control;
    if *filter_s > 0.0 {
        let filtered = FilteredSignals { inputs, filter_s: *filter_s, inertia: *inertia_v_s2_rad };
        (control, phi) = filtered.write(&phi, states, writer);
    }
    if n > 3 {
        let one = writer.local("constant_regressor");
        writer.sum_into(one, Some(1.0), &[]);
        phi.push(one);
    }
    let gate = (*dead_band_m_s2 > 0.0).then(|| {
        let heave = (inputs.signal)(PathSignal::PlatformAcceleration);
        gate(heave, &DeadBand { forget: *forget, rms_m_s2: *dead_band_m_s2 }, states, writer)
    });
    let mut left = write_unexplained(control, &p, &phi, writer);
    if let Some(gate) = gate {
        left = writer.product("gated_unexplained_v", gate, left);
        let gated = |(i, slot): (usize, &Slot)| writer.product(format!("gated_{i}"), gate, *slot);
        phi = phi.iter().enumerate().map(gated).collect();
    }
    let start: Vec<f64> = deviation.iter().take(n).map(|deviation| deviation * deviation).collect();
    let factors = Factors::new(&start, states);
    let keep = factors.keep(*forget, gate, &start, writer);
    let gain = factors.update(&phi, keep, *forget, writer);
    for (i, (p, gain)) in p.iter().zip(gain).enumerate() {
        let move_by = writer.product(format!("move_{i}"), gain, left);
        let next = writer.sum(format!("estimate_next_{i}"), &[1.0 * *p, 1.0 * move_by]);
        writer.copy(*p, next);
    }
}

/// Control and regressors after the same lag.
struct FilteredSignals<'a> {
    inputs: &'a EstimatorInputs<'a>,
    filter_s: f64,
    inertia: [f64; 2],
}

impl FilteredSignals<'_> {
    /// Writes the control less what the inertias take, and the regressors.
    fn write(&self, phi: &[Slot], states: &mut States, writer: &mut Writer) -> (Slot, Vec<Slot>) {
        let hub = (self.inputs.signal)(PathSignal::HubRate);
        let names = ["lift", "direction", "rate"];
        let lagged: Vec<(Slot, Slot)> =
            names.iter().zip(phi).map(|(name, of)| self.lag(name, *of, states, writer)).collect();
        let (_, hub_change) = self.lag("hub_rate", hub, states, writer);
        let (control, _) = self.lag("control", self.inputs.control, states, writer);
        let period_s = self.inputs.parts.sample_period_s;
        let [of_hub, of_rate] = self.inertia.map(|inertia| -inertia / period_s);
        let rate_change = lagged[2].1;
        let terms = [1.0 * control, of_hub * hub_change, of_rate * rate_change];
        let left = writer.sum("control_without_inertia_v", &terms);
        (left, lagged.into_iter().map(|(now, _)| now).collect())
    }

    /// Writes the implicit step of a lag: the value now, and its change.
    fn lag(&self, name: &str, of: Slot, states: &mut States, writer: &mut Writer) -> (Slot, Slot) {
        let period_s = self.inputs.parts.sample_period_s;
        let state = states.scalar(&format!("lagged_{name}"), 0.0, OnRestart::Restart);
        let share = period_s / (self.filter_s + period_s);
        let change = writer.sum(format!("lagged_{name}_change"), &[share * of, -share * state]);
        let next = writer.sum(format!("lagged_{name}_next"), &[1.0 * state, 1.0 * change]);
        writer.copy(state, next);
        (next, change)
    }
}

/// A dead-band on the mean square of the platform's acceleration.
struct DeadBand {
    /// The share of the mean square before it that a sample keeps.
    forget: f64,
    /// RMS of the acceleration below which the estimate stands still, m/s^2.
    rms_m_s2: f64,
}

/// Writes a switch that is 1 while the platform is lively and 0 inside the dead-band. Gravity does not count: what a wrong out-of-balance
/// costs grows with heave, and at rest friction carries what gravity would show.
fn gate(heave: Slot, band: &DeadBand, states: &mut States, writer: &mut Writer) -> Slot {
    let (forget, dead_band) = (band.forget, band.rms_m_s2);
    let liveliness = states.scalar("liveliness", 0.0, OnRestart::Restart);
    let square = writer.product("heave_square", heave, heave);
    let next = writer.sum("liveliness_next", &[forget * liveliness, (1.0 - forget) * square]);
    writer.copy(liveliness, next);
    let slope = 1.0 / ((WHOLE - 1.0) * dead_band * dead_band);
    let beyond = writer.local("beyond_dead_band");
    writer.sum_into(beyond, Some(-1.0 / (WHOLE - 1.0)), &[slope * next]);
    writer.clamp("gate", beyond, Limits::UNIT)
}

/// The size of a regressor in the covariance, before and after one of its components, and what a sample keeps.
struct Sizes {
    before: Slot,
    after: Slot,
    keep: Slot,
}

/// U and D of the covariance: U unit upper triangular, column by column.
struct Factors {
    U: Vec<Vec<Slot>>,
    D: Vec<Slot>,
}

impl Factors {
    fn new(start: &[f64], states: &mut States) -> Self {
        let keep = OnRestart::Restart;
        let mut variance = |(j, d): (usize, &f64)| {
            let slot = states.scalar(&format!("variance_{j}"), *d, keep);
            states.keep_within(StateLimits { low: LEAST_VARIANCE * d, high: MOST_VARIANCE * d });
            slot
        };
        let D: Vec<Slot> = start.iter().enumerate().map(&mut variance).collect();
        let U = (0..start.len())
            .map(|j| (0..j).map(|i| states.scalar(&format!("factor_{i}_{j}"), 0.0, keep)).collect())
            .collect();
        Self { U, D }
    }

    /// Writes what a sample keeps: 1 - (1 - forget) x gate x what the largest variances allow.
    fn keep(&self, forget: f64, gate: Option<Slot>, start: &[f64], writer: &mut Writer) -> Slot {
        let mut allowed: Option<Slot> = gate;
        for (i, &start) in start.iter().enumerate() {
            let variance = self.variance(i, writer);
            let room = writer.local(format!("room_{i}"));
            let span = (WOUND_END - WOUND_START) * start;
            writer.sum_into(room, Some(WOUND_END * start / span), &[-1.0 / span * variance]);
            let room = writer.clamp(format!("may_forget_{i}"), room, Limits::UNIT);
            allowed = Some(match allowed {
                Some(other) => writer.product(format!("may_forget_to_{i}"), other, room),
                None => room,
            });
        }
        let keep = writer.local("keep");
        writer.sum_into(
            keep,
            Some(1.0),
            &allowed.map(|slot| (forget - 1.0) * slot).into_iter().collect::<Vec<_>>(),
        );
        keep
    }

    /// P_ii = sum over j >= i of U_ij^2 D_j.
    fn variance(&self, i: usize, writer: &mut Writer) -> Slot {
        let mut terms = vec![1.0 * self.D[i]];
        for j in i + 1..self.D.len() {
            let square = writer.product(format!("factor_square_{i}_{j}"), self.U[j][i], self.U[j][i]);
            terms.push(1.0 * writer.product(format!("share_{i}_{j}"), square, self.D[j]));
        }
        writer.sum(format!("spread_{i}"), &terms)
    }

    /// Bierman's update; the gain. No size can fall below what a sample keeps: limited there, so that no rounding brings a
    /// divisor to 0.
    fn update(&self, phi: &[Slot], keep: Slot, forget: f64, writer: &mut Writer) -> Vec<Slot> {
        let mut size = keep;
        let mut gain: Vec<Slot> = Vec::new();
        for j in 0..self.D.len() {
            let f = self.write_combination(j, phi, writer);
            let v = writer.product(format!("pull_{j}"), self.D[j], f);
            let square = writer.product(format!("pull_square_{j}"), v, f);
            let told = writer.sum(format!("told_{j}"), &[1.0 * size, 1.0 * square]);
            let next = writer.clamp(format!("size_{j}"), told, Limits { low: forget, high: MOST_TOLD });
            self.shrink(j, &Sizes { before: size, after: next, keep }, writer);
            let p = writer.quotient(format!("lean_{j}"), f, size);
            for i in 0..j {
                let U = self.U[j][i];
                let before = writer.sum(format!("factor_before_{i}_{j}"), &[1.0 * U]);
                let lean = writer.product(format!("lean_{i}_{j}"), gain[i], p);
                let turned = writer.sum(format!("factor_next_{i}_{j}"), &[1.0 * U, -1.0 * lean]);
                writer.copy(U, turned);
                let add = writer.product(format!("pull_{i}_{j}"), before, v);
                gain[i] = writer.sum(format!("gain_{i}_{j}"), &[1.0 * gain[i], 1.0 * add]);
            }
            gain.push(v);
            size = next;
        }
        let scaled = |(i, slot): (usize, &Slot)| writer.quotient(format!("gain_{i}"), *slot, size);
        gain.iter().enumerate().map(scaled).collect()
    }

    /// f_j = phi_j + sum over i < j of U_ij phi_i.
    fn write_combination(&self, j: usize, phi: &[Slot], writer: &mut Writer) -> Slot {
        let mut terms = vec![1.0 * phi[j]];
        for i in 0..j {
            terms.push(1.0 * writer.product(format!("along_{i}_{j}"), self.U[j][i], phi[i]));
        }
        writer.sum(format!("along_{j}"), &terms)
    }

    /// D_j falls by what was seen, and grows by what is forgotten.
    fn shrink(&self, j: usize, sizes: &Sizes, writer: &mut Writer) {
        let share = writer.quotient(format!("left_{j}"), sizes.before, sizes.after);
        let left = writer.product(format!("variance_left_{j}"), self.D[j], share);
        let grown = writer.quotient(format!("variance_next_{j}"), left, sizes.keep);
        writer.copy(self.D[j], grown);
    }
}
