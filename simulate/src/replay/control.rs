//! The recorded control beside what a controller makes of the recorded measurements.
//!
//! Both demand and hub rate are recorded as the controller read them, so its state is known from sample to sample, whatever the
//! machine did: what is left is the rounding of the converters, or another controller was in the loop.

use super::{ChannelFit, RecordedController, fit};
use crate::tolerance::{SAME_CONTROL_SHARE, SHORTEST_WINDOW};
use counterpoise_models::Parameters;
use counterpoise_recordings::{Channel, Recording};

/// Returns the control that a controller makes of the recorded readings, and how well it fits the recorded control. The controller's
/// state at the start, and after each missing sample, is the one that fits best.
///
/// Returns `None` if the control or a channel that the controller reads was not recorded, or if the demand is the hub rate itself: such
/// a recording was made without a controller of its rate.
pub fn control_fit(
    parameters: &Parameters,
    recording: &Recording,
    controller: &RecordedController,
) -> Option<(ChannelFit, Vec<f64>)> {
    let demand = recording.samples(Channel::Demand)?;
    let rate = recording.samples(Channel::HubRate)?;
    let control = recording.samples(Channel::Control)?;
    if demand.iter().zip(rate).all(|(d, r)| d == r || !r.is_finite()) {
        return None;
    }
    let needed = controller.needed_channels().into_iter().map(|channel| recording.samples(channel));
    let needed: Vec<&[f64]> = needed.collect::<Option<_>>()?;
    let mut made = vec![f64::NAN; control.len()];
    let mut from = 0;
    while from < control.len() {
        let whole = |k: usize| control[k].is_finite() && needed.iter().all(|column| column[k].is_finite());
        let to = (from..control.len()).find(|&k| !whole(k)).unwrap_or(control.len());
        if to >= from + SHORTEST_WINDOW {
            made[from..to].copy_from_slice(&controller.compute_control(&recording.part(from..to))?);
            // what a controller knew before its first sample was not recorded
            made[from..(from + controller.unrecorded_samples()).min(to)].fill(f64::NAN);
        }
        from = to + 1;
    }
    let pairs = made.iter().zip(control);
    let compared: Vec<f64> = pairs.map(|(m, c)| if m.is_finite() { *c } else { f64::NAN }).collect();
    let size = control.iter().copied().filter(|v| v.is_finite()).map(|v| v * v).sum::<f64>();
    let size = (size / control.len().max(1) as f64).sqrt();
    let floor = controller.rounding_floor(parameters).max(SAME_CONTROL_SHARE * size);
    let fit = fit(Channel::Control, &made, &compared, floor)?;
    Some((fit, made))
}

#[cfg(test)]
mod tests {
    use super::*;
    use counterpoise_controller::{ProportionalIntegral, Readings, SampledController};
    use counterpoise_models::reference;

    fn controller(kp_v_s_rad: f64) -> ProportionalIntegral {
        ProportionalIntegral {
            kp_v_s_rad,
            ki_v_rad: 80.0,
            bias_v: 2.88,
            sample_period_s: 1e-3,
            ..ProportionalIntegral::default()
        }
    }

    /// Returns a recording whose control is that of a controller with a gain of 18 V s/rad, rounded, with a hole in the hub rate.
    fn recording() -> Recording {
        let demand: Vec<f64> = (0..3000).map(|k| 0.1 * (0.01 * f64::from(k)).sin()).collect();
        let mut rate: Vec<f64> = (0..3000).map(|k| 0.1 * (0.01 * f64::from(k) - 0.2).sin()).collect();
        let mut ready = ProportionalIntegral { integral_v: 0.7, ..controller(18.0) };
        let step = 20.0 / 4096.0;
        let mut one = |(d, r): (&f64, &f64)| {
            let readings = Readings { demand_rad_s: *d, hub_rate_rad_s: *r, ..Readings::default() };
            (ready.step(&readings) / step).round() * step
        };
        let control: Vec<f64> = demand.iter().zip(&rate).map(&mut one).collect();
        rate[1200] = f64::NAN;
        Recording::new("", 1e-3)
            .with(Channel::Demand, demand)
            .with(Channel::HubRate, rate)
            .with(Channel::Control, control)
    }

    #[test]
    fn the_controller_of_the_loop_leaves_the_rounding_and_another_one_more() {
        let rig = reference::rig();
        let ratio = |kp: f64| {
            let (fit, made) = control_fit(&rig, &recording(), &controller(kp).into()).unwrap();
            assert!(made[1200].is_nan() && made[1201].is_finite());
            fit.residual_over_floor()
        };
        assert!(ratio(18.0) < 1.05, "{}", ratio(18.0));
        assert!(ratio(17.0) > 5.0, "{}", ratio(17.0));
    }

    #[test]
    fn what_a_file_rounds_away_is_no_other_controller() {
        let rig = reference::rig();
        let mut ideal = rig.clone();
        (ideal.interface.input_bits, ideal.interface.output_bits) = (40, 40);
        let mut recorded = recording();
        let printed: Vec<f64> = {
            let mut ready = ProportionalIntegral { integral_v: 0.7, ..controller(18.0) };
            let (demand, rate) =
                (recorded.samples(Channel::Demand).unwrap(), recorded.samples(Channel::HubRate).unwrap());
            let one = |(d, r): (&f64, &f64)| {
                let readings = Readings { demand_rad_s: *d, hub_rate_rad_s: *r, ..Readings::default() };
                let control: f64 = format!("{:.5e}", ready.step(&readings)).parse().unwrap();
                control
            };
            demand.iter().zip(&rate[..1200]).map(one).collect()
        };
        recorded.samples_mut(Channel::Control).unwrap()[..1200].copy_from_slice(&printed);
        let recorded = recorded.part(0..1200);
        let ratio =
            |kp: f64| control_fit(&ideal, &recorded, &controller(kp).into()).unwrap().0.residual_over_floor();
        assert!(ratio(18.0) < 1.0, "{}", ratio(18.0));
        assert!(ratio(17.5) > 5.0, "{}", ratio(17.5));
    }

    #[test]
    fn a_recording_without_a_rate_loop_has_none() {
        let recorded = recording();
        let rate = recorded.samples(Channel::HubRate).unwrap().to_vec();
        let followed = recorded.with(Channel::Demand, rate);
        assert!(control_fit(&reference::rig(), &followed, &controller(18.0).into()).is_none());
    }
}
