//! Margins: textbook figures, closed forms, and a flexible loop with many crossings against brute force.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{
    Discretisation, GainChange, Response, StateSpace, Timebase, Zpk, c2d, feedback, hinfnorm, margins, pade,
    parallel, poles, series,
};

fn zpk(zeros: &[C64], poles: &[C64], gain: f64) -> StateSpace {
    let timebase = Timebase::Continuous;
    Zpk { zeros: zeros.to_vec(), poles: poles.to_vec(), gain, timebase }.to_state_space().unwrap()
}

fn re(x: f64) -> C64 {
    C64::new(x, 0.0)
}

/// Skogestad and Postlethwaite's example: G = 3(1-2s)/((10s+1)(5s+1)), K = 1.14(1 + 1/(12.7 s)).
fn skogestad() -> StateSpace {
    zpk(&[re(0.5), re(-1.0 / 12.7)], &[re(-0.1), re(-0.2), re(0.0)], -3.0 * 2.0 * 1.14 / 50.0)
}

#[test]
fn the_textbook_loop_has_the_textbook_margins() {
    let found = margins(&skogestad()).unwrap();
    assert!(found.closed_loop_stable);
    assert!((found.gain_increase().unwrap().factor - 1.6297).abs() < 5e-5);
    assert!((found.phase_margin().unwrap().deg - 19.30).abs() < 5e-3);
    assert!((found.ms.value - 3.937).abs() < 5e-4, "{:?}", found.ms);
    assert!((found.mt.value - 3.368).abs() < 5e-4, "{:?}", found.mt);
}

#[test]
fn the_peaks_are_the_h_infinity_norms_of_s_and_t() {
    let unit = StateSpace::gain(Mat::eye(1), Timebase::Continuous).unwrap();
    let loop_gain = skogestad();
    let found = margins(&loop_gain).unwrap();
    let S = hinfnorm(&feedback(&unit, &loop_gain).unwrap(), 1e-12).unwrap();
    let T = hinfnorm(&feedback(&loop_gain, &unit).unwrap(), 1e-12).unwrap();
    assert!((found.ms.value / S.value - 1.0).abs() < 1e-10);
    assert!((found.mt.value / T.value - 1.0).abs() < 1e-10);
    assert!((found.ms.rate_rad_s / S.rate_rad_s - 1.0).abs() < 1e-4);
}

#[test]
fn a_loop_that_integrates_has_a_complementary_sensitivity_of_at_least_one() {
    // T = k/(s + k) falls from 1 at rest, where L is infinite; with the delay of a sample it does so too below a gain of a half
    for gain in [1e-6, 1.0, 1e6] {
        let found = margins(&zpk(&[], &[re(0.0)], gain)).unwrap();
        assert_eq!(found.mt.value, 1.0, "{gain}");
        assert_eq!(found.disk.alpha, 2.0);
    }
    let one = Mat::eye(1);
    let timebase = Timebase::Discrete { period_s: 1e-3 };
    let step = |gain: f64| Mat::from_fn(1, 1, |_, _| gain);
    let sampled = StateSpace::new(one.clone(), step(0.2), one.clone(), Mat::zeros(1, 1), timebase).unwrap();
    assert_eq!(margins(&sampled).unwrap().mt.value, 1.0);
    // an integrator behind a zero at the origin has a finite gain at rest
    let found = margins(&zpk(&[re(0.0)], &[re(0.0), re(-1.0)], 3.0)).unwrap();
    assert!((found.mt.value - 0.75).abs() < 1e-6, "{:?}", found.mt);
}

#[test]
fn a_triple_lag_has_the_closed_form_gain_margin() {
    // k/(s+1)^3 meets -180 degrees at sqrt(3), where (s+1)^3 = -8.
    let found = margins(&zpk(&[], &[re(-1.0); 3], 2.0)).unwrap();
    let [only] = found.gain.as_slice() else { panic!("{:?}", found.gain) };
    assert!((only.factor - 4.0).abs() < 1e-12 && (only.rate_rad_s - 3.0_f64.sqrt()).abs() < 1e-12);
    assert!((found.delay_s - found.phase[0].deg.to_radians() / found.phase[0].rate_rad_s).abs() < 1e-12);
}

#[test]
fn a_conditionally_stable_loop_has_a_margin_each_way() {
    // k (s+1)^2/s^3 is stable for k > 1/2: the gain may fall to a half of one, and rise without limit.
    let found = margins(&zpk(&[re(-1.0); 2], &[re(0.0); 3], 1.0)).unwrap();
    assert!(found.closed_loop_stable && found.gain_increase().is_none());
    let down = found.gain_decrease().unwrap();
    assert!((down.factor - 0.5).abs() < 1e-12 && down.change == GainChange::Decrease && down.db < 0.0);
}

#[test]
fn a_loop_of_unstable_plant_crosses_at_zero_frequency() {
    // 3/(s-1): stable for gains above 1/3, and the crossing is at zero frequency.
    let found = margins(&zpk(&[], &[re(1.0)], 3.0)).unwrap();
    assert!(found.closed_loop_stable);
    let [only] = found.gain.as_slice() else { panic!("{:?}", found.gain) };
    assert!(only.rate_rad_s == 0.0 && (only.factor - 1.0 / 3.0).abs() < 1e-14);
}

#[test]
fn a_sampled_integrator_crosses_at_half_the_sampling_rate() {
    // T/(z-1) times k is stable for k T < 2.
    let g = c2d(&zpk(&[], &[re(0.0)], 1.0), 0.1, Discretisation::ZeroOrderHold).unwrap();
    let found = margins(&g).unwrap();
    let up = found.gain_increase().unwrap();
    assert!((up.factor - 20.0).abs() < 1e-11 && (up.rate_rad_s - std::f64::consts::PI / 0.1).abs() < 1e-12);
}

/// Returns a collocated and a non-collocated flexible loop with `modes` lightly damped modes and a delay.
fn flexible_loop(modes: usize, zeta: f64) -> StateSpace {
    let mut sum = zpk(&[], &[re(0.0), re(-0.5)], 40.0);
    for k in 1..=modes {
        let rate = 7.0 * k as f64 + 1.3 * (k * k) as f64;
        let pole = C64::new(-zeta, (1.0 - zeta * zeta).sqrt()) * rate;
        let sign = if k % 3 == 0 { -1.0 } else { 1.0 };
        sum = parallel(&sum, &zpk(&[], &[pole, pole.conj()], sign * 12.0 * rate)).unwrap();
    }
    series(&sum, &pade(0.01, 3).unwrap()).unwrap()
}

/// Crossings counted on a brute-force grid of `count` points from 1e-2 to 1e4 rad/s.
fn brute_force(g: &StateSpace, count: usize) -> (Vec<f64>, Vec<f64>) {
    let response = Response::of(g).unwrap();
    let rates: Vec<f64> =
        (0..count).map(|k| 10.0_f64.powf(-2.0 + 6.0 * k as f64 / (count - 1) as f64)).collect();
    let values: Vec<C64> = response.at_all(&rates).unwrap().iter().map(|H| H[(0, 0)]).collect();
    let (mut gain, mut phase) = (Vec::new(), Vec::new());
    for k in 1..count {
        let (a, b) = (values[k - 1], values[k]);
        if (a.im < 0.0) != (b.im < 0.0) && a.re + b.re < 0.0 {
            gain.push(rates[k]);
        }
        if (a.norm() < 1.0) != (b.norm() < 1.0) {
            phase.push(rates[k]);
        }
    }
    (gain, phase)
}

#[test]
fn every_crossing_of_a_flexible_loop_is_found() {
    for (modes, zeta) in [(4, 0.002), (8, 0.005), (12, 0.001), (20, 0.002)] {
        let g = flexible_loop(modes, zeta);
        let found = margins(&g).unwrap();
        let (gain, phase) = brute_force(&g, 200_000);
        assert!(phase.len() > modes, "{modes}: {}", phase.len());
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-4;
        assert_eq!(found.phase.len(), phase.len());
        assert!(found.phase.iter().zip(&phase).all(|(margin, &rate)| near(margin.rate_rad_s, rate)));
        assert_eq!(found.gain.len(), gain.len());
        assert!(found.gain.iter().zip(&gain).all(|(margin, &rate)| near(margin.rate_rad_s, rate)));
    }
}

#[test]
fn at_each_margin_the_closed_loop_has_a_pole_on_the_axis() {
    let g = flexible_loop(6, 0.01);
    let found = margins(&g).unwrap();
    for margin in &found.gain {
        let unit = StateSpace::gain(Mat::eye(1).scale(margin.factor), Timebase::Continuous).unwrap();
        let closed = poles(&feedback(&g, &unit).unwrap()).unwrap();
        let target = C64::new(0.0, margin.rate_rad_s);
        let distance = closed.iter().map(|p| (p - target).norm()).fold(f64::INFINITY, f64::min);
        assert!(distance < 1e-9 * (1.0 + target.norm()), "{margin:?}: {distance}");
    }
}

#[test]
fn an_undamped_resonance_does_not_stop_the_search() {
    let pole = C64::new(0.0, 5.0);
    let found = margins(&zpk(&[re(-1.0)], &[pole, pole.conj(), re(-30.0)], 60.0)).unwrap();
    assert!(found.closed_loop_stable);
    assert!(!found.phase.is_empty());
}

#[test]
fn the_disk_margin_lies_within_the_classical_ones() {
    let found = margins(&skogestad()).unwrap();
    let disk = found.disk;
    assert!(disk.highest_gain <= found.gain_increase().unwrap().factor);
    assert!(disk.phase_deg <= found.phase_margin().unwrap().deg);
    assert!(disk.alpha > 0.2 && disk.alpha < 0.4, "{disk:?}");
}

#[test]
fn a_double_integrator_in_rotated_coordinates_with_a_zero_at_the_origin_crosses_one() {
    // 16 / s in two states: rounding leaves poles of 2e-17, at whose frequencies the response is not known.
    let A = Mat::from_rows(&[&[-0.125, 0.125], &[-0.125, 0.125]]);
    let (B, C) = (Mat::col(&[-1.0, -1.0]), Mat::row(&[16.0, -32.0]));
    let found = margins(&StateSpace::new(A, B, C, Mat::zeros(1, 1), Timebase::Continuous).unwrap()).unwrap();
    assert_eq!(found.phase.len(), 1, "{found:?}");
    assert!((found.phase[0].rate_rad_s - 16.0).abs() < 1e-9 && (found.phase[0].deg - 90.0).abs() < 1e-9);
}
