//! The places of the knots of the amplifier's curve, chosen by held-out stretches.
//!
//! A curve that was found with its knots at the usual inputs bends there, and the machine's elsewhere. What each knot of a fine
//! curve does to the residuals is computed by the simulator once; from then on every choice of knots is a linear fit. The
//! recordings are cut into stretches of a second; each choice is fitted to every second stretch and assessed on the others, and
//! vice versa. Knots are added, moved and removed while that is worth their price.

use crate::tolerance::selection::{CURVE_PREFERENCE, CURVE_STEP, SAME_KNOT};
use counterpoise_linalg::{Mat, solve};
use counterpoise_simulate::replay::{START_FREEDOMS, start_has};

use crate::fitting::StartColumns;
use crate::fitting::output_error::FitSelection;
use crate::library::{Effect, gain_curve_inputs, make_gain_curve};
use crate::recording::series::correlation_time;
use crate::recording::series::dot;
use crate::selection::candidate::FittedCandidate;
use crate::selection::searcher::Searcher;
use crate::simulator_access::{Assessment, ChannelResidual, Span, StartShift};
use crate::tolerance::selection::SAME_GRID_PLACE;
use crate::tolerance::{
    KNOT_GAP_V, KNOT_ITERATIONS, KNOT_MOVE_GAIN, KNOT_MOVES, KNOT_PRICE, KNOT_ROUNDS, KNOT_SHARE,
    KNOT_SPACING_V, KNOT_STRETCH, KNOTS_AT_MOST,
};
use counterpoise_pool::map;

impl Searcher<'_> {
    /// Returns a candidate with the knots of its curve where the recordings require them; unchanged if it has no curve.
    pub(crate) fn place_curve_knots(&self, mut candidate: FittedCandidate) -> FittedCandidate {
        for _ in 0..KNOT_ROUNDS {
            match self.move_curve_knots(&candidate) {
                Some(sharper) => candidate = sharper,
                None => break,
            }
        }
        candidate
    }

    /// Returns the candidate with other knots if those explain more.
    fn move_curve_knots(&self, candidate: &FittedCandidate) -> Option<FittedCandidate> {
        let effects = &candidate.fit.effects;
        let place = effects.iter().position(|e| gain_curve_inputs(e).is_some())?;
        let present = gain_curve_inputs(effects[place])?;
        let fine = fine_inputs(present);
        let knots = self.slopes(candidate, &fine)?.choose_knots(present);
        let inputs: Vec<f64> = knots.iter().map(|&k| fine[k]).collect();
        if inputs == present || self.pool.is_cancelled() {
            return None;
        }
        let mut effects = effects.clone();
        effects[place] = make_gain_curve(&inputs);
        let start: Vec<f64> = effects.iter().flat_map(|e| e.values(&candidate.fit.parameters)).collect();
        let selection = FitSelection {
            iterations: KNOT_ITERATIONS,
            restarts: 0,
            ..FitSelection::all(self.simulator.count())
        };
        let fit = self.fit(effects, &start, &selection, &candidate.assessments)?;
        self.replace_fit(candidate, fit).filter(|sharper| sharper.log_likelihood_deficit(candidate) < 0.0)
    }

    /// Returns what each knot of a fine curve does to all recordings.
    fn slopes(&self, candidate: &FittedCandidate, fine: &[f64]) -> Option<Slopes> {
        let mut slopes = Slopes::new(fine, make_gain_curve(fine).values(&candidate.fit.parameters));
        for recording in 0..self.simulator.count() {
            let (residual, columns) = self.columns(candidate, recording, make_gain_curve(fine))?;
            slopes.add(&residual, &columns);
        }
        slopes.samples_of_one /= slopes.samples.max(1.0);
        Some(slopes)
    }

    /// Returns the residuals of a recording, channel by channel, and what each knot of the fine curve does to them, without what
    /// the initial state could do instead.
    fn columns(
        &self,
        candidate: &FittedCandidate,
        recording: usize,
        fine: &'static Effect,
    ) -> Option<Columns> {
        let near = candidate.assessments.get(recording)?;
        let values = fine.values(&candidate.fit.parameters);
        let parameters = fine.apply_to(&candidate.fit.parameters, &values);
        let channels =
            weight_residuals(self.simulator.residuals(&parameters, recording, Span::Whole, near)?, near);
        let length = channels.first().map_or(0, Vec::len);
        let residual: Vec<f64> = channels.into_iter().flatten().collect();
        let change = |there: Vec<ChannelResidual>, by: f64| -> Vec<f64> {
            let there = weight_residuals(there, near).into_iter().flatten();
            there.zip(&residual).map(|(a, b)| (a - b) / by).collect()
        };
        let columns = map(self.pool, values.len(), |k| {
            let mut moved = values.clone();
            moved[k] += CURVE_STEP;
            let there = fine.apply_to(&parameters, &moved);
            Some(change(self.simulator.residuals(&there, recording, Span::Whole, near)?, CURVE_STEP))
        });
        let columns: Vec<Vec<f64>> = columns.into_iter().collect::<Option<_>>()?;
        let starts = map(self.pool, START_FREEDOMS, |k| {
            let shift: StartShift = std::array::from_fn(|j| f64::from(u8::from(j == k)));
            let there = || {
                self.simulator.residuals_from_shifted_start(&parameters, recording, Span::Whole, near, &shift)
            };
            let there = start_has(&parameters, k).then(there).flatten()?.0;
            Some(change(there, 1.0)).filter(|column| column.iter().any(|v| *v != 0.0))
        });
        let starts = StartColumns::new(starts);
        let left = |series: &Vec<f64>| starts.subtract_shift(series, &starts.fit_shift(series));
        let whole = columns.len() == values.len();
        whole.then(|| (Series { values: left(&residual), length }, columns.iter().map(left).collect()))
    }
}

/// Returns the residuals of each channel with the weights of a fit.
fn weight_residuals(channels: Vec<ChannelResidual>, near: &Assessment) -> Vec<Vec<f64>> {
    let one = |(c, channel): (usize, ChannelResidual)| {
        let weight = near.weight(c);
        channel.residual.into_iter().map(|r| weight * r).collect()
    };
    channels.into_iter().enumerate().map(one).collect()
}

/// Residuals and columns of one recording.
type Columns = (Series, Vec<Vec<f64>>);

/// Channels of a recording, one after the other.
struct Series {
    values: Vec<f64>,
    /// Samples of a channel.
    length: usize,
}

/// Returns the inputs of a fine curve that has all knots of another.
fn fine_inputs(present: &[f64]) -> Vec<f64> {
    let last = present.last().copied().unwrap_or(0.0);
    let count = (last / KNOT_SPACING_V - SAME_GRID_PLACE).floor() as usize;
    // rounded so that the result reads well
    let grid = |k: usize| (1e6 * k as f64 * KNOT_SPACING_V).round() / 1e6;
    let mut inputs: Vec<f64> = (1..=count).map(grid).collect();
    let close = |a: f64, b: f64| (a - b).abs() < SAME_KNOT * KNOT_SPACING_V;
    inputs.retain(|v| !present.iter().any(|p| close(*p, *v)));
    inputs.extend(present);
    inputs.sort_by(f64::total_cmp);
    inputs
}

/// Curvature, gradient and cost of the fine curve's points, for each half of the stretches.
struct Slopes {
    inputs: Vec<f64>,
    /// The present curve, as fractions of the linear gain.
    fractions: Vec<f64>,
    halves: [Half; 2],
    samples: f64,
    /// Samples that carry the information of one.
    samples_of_one: f64,
}

struct Half {
    normal: Mat,
    gradient: Vec<f64>,
    cost: f64,
}

impl Slopes {
    fn new(inputs: &[f64], fractions: Vec<f64>) -> Self {
        let count = inputs.len();
        let half = || Half { normal: Mat::zeros(count, count), gradient: vec![0.0; count], cost: 0.0 };
        let halves = [half(), half()];
        Self { inputs: inputs.to_vec(), fractions, halves, samples: 0.0, samples_of_one: 0.0 }
    }

    /// Adds a recording.
    fn add(&mut self, residual: &Series, columns: &[Vec<f64>]) {
        let mut own = Slopes::new(&self.inputs, self.fractions.clone()).halves;
        let mut from = 0;
        while from < residual.values.len() {
            let inside = from % residual.length;
            let to = from + (KNOT_STRETCH - inside % KNOT_STRETCH).min(residual.length - inside);
            own[inside / KNOT_STRETCH % 2].add(&residual.values[from..to], columns, from);
            from = to;
        }
        let rest = self.rest(residual, columns, &own);
        for channel in rest.chunks(residual.length.max(1)) {
            self.samples_of_one += channel.len() as f64 * correlation_time(channel);
            self.samples += channel.len() as f64;
        }
        self.halves.iter_mut().zip(&own).for_each(|(half, own)| half.join(own));
    }

    /// Returns what no choice of knots explains of a recording: its correlation time gives the number of samples that carry the
    /// information of one.
    fn rest(&self, residual: &Series, columns: &[Vec<f64>], own: &[Half; 2]) -> Vec<f64> {
        let all: Vec<usize> = (0..self.inputs.len()).collect();
        let mut both =
            Half { normal: own[0].normal.clone(), gradient: own[0].gradient.clone(), cost: own[0].cost };
        both.join(&own[1]);
        let mut rest = residual.values.clone();
        for (change, column) in both.solve_fractions(&self.hats(&all)).unwrap_or_default().iter().zip(columns)
        {
            rest.iter_mut().zip(column).for_each(|(r, c)| *r += change * c);
        }
        rest
    }

    /// Returns the knots that are worth their price, as indices of the inputs; the search starts from the present ones, and the
    /// last knot stays.
    fn choose_knots(&self, present: &[f64]) -> Vec<usize> {
        let mut knots: Vec<usize> =
            (0..self.inputs.len()).filter(|&k| present.contains(&self.inputs[k])).collect();
        let mut cost = self.cross_validated_cost(&knots);
        let all: Vec<usize> = (0..self.inputs.len()).collect();
        let price = KNOT_PRICE.max(KNOT_SHARE * self.gain(cost, self.cross_validated_cost(&all)));
        while knots.len() < KNOTS_AT_MOST {
            let Some((better, least)) = self.best_with_one_more(&knots) else { break };
            if self.gain(cost, least) < price {
                break;
            }
            (knots, cost) = (better, least);
        }
        for _ in 0..KNOT_MOVES {
            let before = knots.clone();
            self.move_knots(&mut knots, &mut cost);
            self.prune_knots(&mut knots, &mut cost, price);
            if knots == before {
                break;
            }
        }
        knots
    }

    /// Returns the best choice with one more knot.
    fn best_with_one_more(&self, knots: &[usize]) -> Option<(Vec<usize>, f64)> {
        let apart = |k: usize, other: usize| (self.inputs[k] - self.inputs[other]).abs() > KNOT_GAP_V;
        let free = (0..self.inputs.len()).filter(|&k| knots.iter().all(|&other| apart(k, other)));
        let more = free.map(|k| {
            let mut more = knots.to_vec();
            more.push(k);
            more.sort_unstable();
            let cost = self.cross_validated_cost(&more);
            (more, cost)
        });
        more.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Moves each knot to where it is worth most.
    fn move_knots(&self, knots: &mut Vec<usize>, cost: &mut f64) {
        for k in 0..knots.len().saturating_sub(1) {
            let mut without = knots.clone();
            without.remove(k);
            match self.best_with_one_more(&without) {
                Some((better, least)) if self.gain(*cost, least) > KNOT_MOVE_GAIN => {
                    (*knots, *cost) = (better, least);
                }
                _ => {}
            }
        }
    }

    /// Removes knots that are not worth their price, the idlest first.
    fn prune_knots(&self, knots: &mut Vec<usize>, cost: &mut f64, price: f64) {
        while knots.len() > 2 {
            let fewer = (0..knots.len() - 1).map(|k| {
                let mut fewer = knots.clone();
                fewer.remove(k);
                let cost = self.cross_validated_cost(&fewer);
                (fewer, cost)
            });
            match fewer.min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((fewer, least)) if self.gain(least, *cost) < price => {
                    (*knots, *cost) = (fewer, least);
                }
                _ => return,
            }
        }
    }

    /// Returns the log-likelihood that a lower cost is worth.
    fn gain(&self, before: f64, after: f64) -> f64 {
        0.5 * self.samples / self.samples_of_one.max(1.0) * (before / after).ln()
    }

    /// Returns the cost of each half when a choice of knots is fitted to the other.
    fn cross_validated_cost(&self, knots: &[usize]) -> f64 {
        let hats = self.hats(knots);
        let one = |(fitted, other): (&Half, &Half)| {
            fitted.solve_fractions(&hats).map_or(f64::INFINITY, |change| other.cost_after(&change))
        };
        let [first, second] = &self.halves;
        one((first, second)) + one((second, first))
    }

    /// Returns how the fine curve's knots follow those of a choice, between which the current is a straight line.
    fn hats(&self, knots: &[usize]) -> Hats {
        let mut rows = Vec::with_capacity(self.inputs.len());
        let mut next = 0;
        for (k, &v) in self.inputs.iter().enumerate() {
            while next + 1 < knots.len() && knots[next] < k {
                next += 1;
            }
            let to = self.inputs[knots[next]];
            let from = if next > 0 { self.inputs[knots[next - 1]] } else { 0.0 };
            let share = (v - from) / (to - from);
            rows.push([(next.saturating_sub(1), (1.0 - share) * from / v), (next, share * to / v)]);
        }
        let straight = |(row, own): (&[(usize, f64); 2], &f64)| {
            row.iter().map(|&(s, a)| a * self.fractions[knots[s]]).sum::<f64>() - own
        };
        let bend = rows.iter().zip(&self.fractions).map(straight).collect();
        Hats { rows, bend, count: knots.len() }
    }
}

/// Fractions of the fine curve = rows x those of a choice of points.
struct Hats {
    /// The two points of the choice that each point of the fine curve lies between, with their shares.
    rows: Vec<[(usize, f64); 2]>,
    /// By how much the present curve changes when it is drawn through the chosen points.
    bend: Vec<f64>,
    count: usize,
}

impl Half {
    /// Adds a stretch of a recording.
    fn add(&mut self, residual: &[f64], columns: &[Vec<f64>], from: usize) {
        self.cost += dot(residual, residual);
        let of = |k: usize| &columns[k][from..from + residual.len()];
        for i in 0..columns.len() {
            self.gradient[i] += dot(of(i), residual);
            for j in 0..=i {
                let both = dot(of(i), of(j));
                self.normal[(i, j)] += both;
                if i != j {
                    self.normal[(j, i)] += both;
                }
            }
        }
    }

    /// Adds another recording.
    fn join(&mut self, other: &Self) {
        self.normal = &self.normal + &other.normal;
        self.gradient.iter_mut().zip(&other.gradient).for_each(|(a, b)| *a += b);
        self.cost += other.cost;
    }

    /// Returns the change of the fine curve's fractions that fits best with the knots of a choice.
    fn solve_fractions(&self, hats: &Hats) -> Option<Vec<f64>> {
        let mut normal =
            Mat::from_fn(hats.count, hats.count, |i, j| if i == j { CURVE_PREFERENCE } else { 0.0 });
        let mut right = Mat::zeros(hats.count, 1);
        for (k, row) in hats.rows.iter().enumerate() {
            let pull: f64 = self.gradient[k] + dot(self.normal.column(k), &hats.bend);
            for &(s, a) in row {
                right[(s, 0)] -= a * pull;
            }
            for (l, other) in hats.rows.iter().enumerate() {
                let both = self.normal[(k, l)];
                for (&(s, a), &(t, b)) in row.iter().flat_map(|x| other.iter().map(move |y| (x, y))) {
                    normal[(s, t)] += a * b * both;
                }
            }
        }
        let found = solve(&normal, &right).ok().filter(Mat::is_finite)?;
        let change = |(row, bend): (&[(usize, f64); 2], &f64)| {
            row.iter().map(|&(s, a)| a * found[(s, 0)]).sum::<f64>() + bend
        };
        Some(hats.rows.iter().zip(&hats.bend).map(change).collect())
    }

    /// Returns the cost after a change of the fine curve's fractions.
    fn cost_after(&self, change: &[f64]) -> f64 {
        let curved: f64 = (0..change.len()).map(|k| change[k] * dot(self.normal.column(k), change)).sum();
        self.cost + 2.0 * dot(&self.gradient, change) + curved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A recording in which every point of the fine curve has its own samples, and the machine's curve bends at 0.3 V.
    fn slopes(bent: f64) -> Slopes {
        let present = [0.2, 0.4, 0.6, 1.0];
        let inputs = fine_inputs(&present);
        let mut slopes = Slopes::new(&inputs, vec![1.0; inputs.len()]);
        let length = 8 * KNOT_STRETCH;
        let column = |k: usize| -> Vec<f64> {
            (0..length).map(|t| if t % inputs.len() == k { 40.0 } else { 0.0 }).collect()
        };
        let columns: Vec<Vec<f64>> = (0..inputs.len()).map(column).collect();
        let lacking = |v: f64| bent * (v.min(0.3) / 0.3).min(1.0) * ((1.0 - v) / 0.7).min(1.0) / v;
        let mut seed = 1_u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            3.46 * ((seed >> 33) as f64 / (1u64 << 31) as f64 - 0.5)
        };
        let values = (0..length).map(|t| noise() - 40.0 * lacking(inputs[t % inputs.len()])).collect();
        slopes.add(&Series { values, length }, &columns);
        slopes.samples_of_one /= slopes.samples;
        slopes
    }

    fn inputs(slopes: &Slopes) -> Vec<f64> {
        slopes.choose_knots(&[0.2, 0.4, 0.6, 1.0]).into_iter().map(|k| slopes.inputs[k]).collect()
    }

    #[test]
    fn a_point_is_put_where_the_machine_s_curve_bends_and_idle_ones_are_taken_away() {
        assert_eq!(inputs(&slopes(0.1)), [0.3, 1.0]);
    }

    #[test]
    fn a_straight_curve_keeps_no_points_but_the_fewest() {
        assert_eq!(inputs(&slopes(0.0)).len(), 2);
    }
}
