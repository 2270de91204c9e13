//! The figures of a loop on the grid, without slopes: what a search over many designs compares.

use counterpoise_linalg::C64;

use super::LoopLimits;
use super::LoopMeasures;
use super::crossings::crossings;
use super::grid::LoopPlant;
use super::limits::pole_region;
use super::loop_response::TuningResponse;
use super::problem::Problem;
use crate::Error;

impl Problem<'_> {
    /// Returns the figures of the loop on each plant; `None` if a loop is not stable.
    ///
    /// # Errors
    /// Those of the family at the point.
    pub fn grid_measures(&self, at: &[f64]) -> Result<Option<Vec<LoopMeasures>>, Error> {
        let gain = self.family.gain(at, &self.grid)?;
        let K = self.family.unchecked_feedback(at)?;
        let slopes = vec![Vec::new(); gain.len()];
        let mut all = Vec::new();
        for (plant, poles) in self.plants.iter().zip(self.closed_poles(&K)?) {
            if !poles.iter().all(|pole| pole.norm() < 1.0) {
                return Ok(None);
            }
            let mut found = self.measure_response(plant, &gain, &slopes);
            (found.decay_rad_s, found.damping) = pole_region(&poles, &plant.system, found.crossover_rad_s);
            all.push(found);
        }
        Ok(if self.holds(&K)? { Some(all) } else { None })
    }

    fn measure_response(&self, plant: &LoopPlant, gain: &[C64], slopes: &[Vec<C64>]) -> LoopMeasures {
        let L: Vec<C64> = plant.response.iter().zip(gain).map(|(P, K)| P * K).collect();
        let S: Vec<C64> = L.iter().map(|L| (C64::ONE + L).inv()).collect();
        let effort: Vec<f64> = gain.iter().zip(&S).map(|(K, S)| (K * S).norm()).collect();
        let noise = self.task.disturbance.reading_noise_rad_s.powi(2);
        let (mut left, mut control, mut of_noise) = (0.0, 0.0, 0.0);
        let mut largest = [0.0_f64; 3];
        for k in 0..S.len() {
            let T = L[k] * S[k];
            let (power, share) = (self.grid.power[k], self.grid.share[k]);
            left += power * S[k].norm_sqr() + noise * share * T.norm_sqr();
            control += power * effort[k].powi(2);
            of_noise += share * effort[k].powi(2);
            for (most, size) in largest.iter_mut().zip([S[k].norm(), T.norm(), effort[k]]) {
                *most = most.max(size);
            }
        }
        let crossover = (0..L.len()).rev().find(|&k| L[k].norm() > 1.0).map_or(0.0, |k| self.grid.rates[k]);
        let response = TuningResponse { rates: &self.grid.rates, L, S, effort, slopes };
        // Under a limit of 1 a row's value is 1 less the margin.
        let margin = |limits: LoopLimits| {
            crossings(&response, &limits).iter().map(|row| 1.0 - row.value).fold(f64::INFINITY, f64::min)
        };
        let none = LoopLimits::default();
        LoopMeasures {
            max_sensitivity: largest[0],
            max_complementary: largest[1],
            gain_margin_db: margin(LoopLimits { gain_margin_db: 1.0, ..none }),
            phase_margin_deg: margin(LoopLimits { phase_margin_deg: 1.0, ..none }),
            delay_margin_s: margin(LoopLimits { delay_margin_s: 1.0, ..none }),
            crossover_rad_s: crossover,
            noise_gain: of_noise.sqrt(),
            control_peak: largest[2],
            effort_v: control.sqrt(),
            residual_rad_s: left.sqrt(),
            decay_rad_s: 0.0,
            damping: 0.0,
        }
    }
}
