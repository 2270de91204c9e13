use super::{Mass, assert_close, model, reset_integrator};
use counterpoise_models::FrictionLaw;
use counterpoise_models::friction::FrictionModel;

const STIFFNESS: f64 = 2.0;
const PULL: f64 = 0.1;

/// One stick and one slip of a pulled unit mass with true stick: (stick time, restick force, slip time, top rate).
fn cycle(friction: &FrictionModel, start_force: f64) -> (f64, f64, f64, f64) {
    let h = 2e-6;
    let stick = friction.stick(1.0).unwrap();
    let mut stuck = 0.0;
    while stick.holds(start_force + STIFFNESS * PULL * stuck) {
        stuck += h;
    }
    let mut stretch = (start_force + STIFFNESS * PULL * stuck) / STIFFNESS;
    let (mut rate, mut slipped, mut fastest) = (0.0_f64, 0.0, 0.0_f64);
    loop {
        let net = |stretch: f64, rate: f64| STIFFNESS * stretch - friction.torque(rate.max(1e-300), 1.0, &[]);
        let middle_rate = rate + 0.5 * h * net(stretch, rate);
        let middle = stretch + 0.5 * h * (PULL - rate);
        rate += h * net(middle, middle_rate);
        stretch += h * (PULL - middle_rate);
        slipped += h;
        fastest = fastest.max(rate);
        if rate <= 0.0 {
            return (stuck, STIFFNESS * stretch, slipped, fastest);
        }
    }
}

#[test]
fn true_stick_has_the_closed_form_cycle() {
    let laws = [
        FrictionLaw::Coulomb { coulomb_nm: 1.0 },
        FrictionLaw::Karnopp { coulomb_nm: 1.0, stick_rate_rad_s: 1e-6 },
    ];
    for law in laws {
        let (stuck, force, slipped, fastest) = cycle(&model(law, 1.5, 1.0), 0.5);
        assert_close(stuck, 5.0, 5e-6);
        assert_close(force, 0.5, 1e-5);
        let omega = STIFFNESS.sqrt();
        let slip = 2.0 / omega * (std::f64::consts::PI - (0.25_f64).atan2(PULL / omega));
        assert_close(slipped, slip, 1e-5);
        assert_close(fastest, 0.467423461, 1e-6);
    }
}

#[test]
fn coulomb_takes_four_levels_over_stiffness_from_each_swing() {
    let friction = model(FrictionLaw::Coulomb { coulomb_nm: 0.1 }, 1.0, 1.0);
    let (h, mut x, mut v) = (1e-5, 1.0_f64, 0.0_f64);
    let mut swings = Vec::new();
    while swings.len() < 4 {
        let towards = if v == 0.0 { -1e-300 } else { v };
        let old = v;
        let slope = |x: f64, v: f64| -STIFFNESS * x - friction.torque(v, 1.0, &[]);
        let middle_v = v + 0.5 * h * slope(x, towards);
        v += h * slope(x + 0.5 * h * old, middle_v);
        x += h * middle_v;
        if old > 0.0 && v <= 0.0 {
            swings.push(x);
        }
    }
    for pair in swings.windows(2) {
        assert_close(pair[0] - pair[1], 4.0 * 0.1 / STIFFNESS, 1e-4);
    }
}

#[test]
fn the_reset_integrator_resticks_without_chatter() {
    let friction = reset_integrator();
    let mut mass = Mass::new(&friction);
    let spring = |t: f64, x: f64| STIFFNESS * (PULL * t - x);
    let (mut slides, mut sliding) = (Vec::new(), false);
    while mass.time_s < 40.0 {
        mass.step(1e-4, &spring);
        let now = mass.state[2].abs() >= 1e-4;
        if now && !sliding {
            slides.push(mass.time_s);
        }
        sliding = now;
    }
    let last = slides.len() - 1;
    assert_close(slides[last] - slides[last - 1], 7.611, 0.05);
    assert_eq!(slides.len(), 5, "{slides:?}");
}
