use super::{Mass, assert_close, lugre};

#[test]
fn the_steady_curve_is_stribeck_with_viscous() {
    let friction = lugre();
    for rate in [-0.01, -1e-3, 5e-4, 2e-3, 0.3_f64] {
        let expected = (1.0 + 0.5 * (-(rate / 1e-3).powi(2)).exp()) * rate.signum() + 0.4 * rate;
        assert_close(friction.steady_torque(rate), expected, 1e-15);
        let mut z = [0.0];
        friction.advance(rate, 1.0, 1.0, &mut z);
        assert_close(friction.torque(rate, 1.0, &z), expected, 1e-12);
    }
}

#[test]
fn a_pulled_mass_sticks_and_slips_with_the_published_period() {
    let friction = lugre();
    let mut mass = Mass::new(&friction);
    let spring = |t: f64, x: f64| 2.0 * (0.1 * t - x);
    let (mut peaks, mut least, mut fastest) = (Vec::new(), f64::INFINITY, 0.0_f64);
    let mut before = [0.0; 2];
    while mass.time_s < 40.0 {
        mass.step(2e-5, &spring);
        let force = spring(mass.time_s, mass.state[0]);
        if before[1] > before[0] && before[1] > force && before[1] > 1.2 {
            peaks.push((mass.time_s, before[1]));
        }
        if peaks.len() > 1 {
            least = least.min(force);
            fastest = fastest.max(mass.state[1]);
        }
        before = [before[1], force];
    }
    let periods = peaks.len() - 2;
    assert_close((peaks[periods + 1].0 - peaks[1].0) / periods as f64, 6.363, 0.001);
    assert_close(peaks[2].1, 1.5080, 1e-4);
    assert_close(least, 0.7412, 1e-4);
    assert_close(fastest, 0.3698, 1e-4);
}

#[test]
fn breakaway_falls_with_the_rate_of_the_force() {
    let rates_n_s = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0];
    let published = [1.4324, 1.3944, 1.3132, 1.2200, 1.0986, 1.0075];
    for (rate, expected) in rates_n_s.into_iter().zip(published) {
        let friction = lugre();
        let mut mass = Mass::new(&friction);
        let mut highest = 0.0_f64;
        while mass.torque() >= highest {
            highest = highest.max(mass.torque());
            mass.step(1e-5, &|t, _| rate * t);
        }
        assert_close(highest, expected, 1e-4);
    }
}

#[test]
fn presliding_closes_its_loop() {
    let friction = lugre();
    let mut mass = Mass::new(&friction);
    let triangle = |t: f64, _: f64| {
        let phase = (t / 40.0).fract();
        1.425
            * if phase < 0.25 {
                4.0 * phase
            } else if phase < 0.75 {
                2.0 - 4.0 * phase
            } else {
                4.0 * phase - 4.0
            }
    };
    let mut turns = Vec::new();
    let h = 5e-4;
    for k in 1..=180_000 {
        mass.time_s = f64::from(k - 1) * h;
        mass.step(h, &triangle);
        if (k - 20_000) % 40_000 == 0 {
            turns.push(mass.state[0] * 1e6);
        }
    }
    assert_close(turns[0], 44.858, 1e-2);
    assert_close(turns[1], -9.732, 1e-2);
    assert_close(turns[3], turns[1], 1e-3);
    assert_close(turns[4], turns[2], 1e-3);
}

#[test]
fn friction_lags_behind_a_varying_rate() {
    let published = [
        (1.0, 1.05415, 1.05250, 1.405e-5),
        (10.0, 1.06499, 1.04695, 1.068e-4),
        (25.0, 1.09349, 1.04144, 1.653e-4),
    ];
    for (frequency, accelerating, decelerating, area) in published {
        let friction = lugre();
        let steps = 40_000;
        let h = std::f64::consts::TAU / frequency / f64::from(steps);
        let rate =
            |k: i32| 1.5e-3 * (1.0 + 0.9 * (std::f64::consts::TAU * f64::from(k) / f64::from(steps)).sin());
        let mut z = [0.0];
        let mut torques = Vec::new();
        for k in 0..3 * steps {
            if k >= 2 * steps {
                torques.push(friction.torque(rate(k), 1.0, &z) - 0.4 * rate(k));
            }
            friction.advance(0.5 * (rate(k) + rate(k + 1)), h, 1.0, &mut z);
        }
        let viscous = 0.4 * 1.5e-3;
        assert_close(torques[0] + viscous, accelerating, 2e-5);
        assert_close(torques[steps as usize / 2] + viscous, decelerating, 2e-5);
        let swept: f64 = torques
            .iter()
            .enumerate()
            .map(|(k, f)| f * 0.5 * (rate(k as i32 + 1) - rate(k as i32 - 1)))
            .sum();
        assert_close(swept / area, 1.0, 1e-3);
    }
}
