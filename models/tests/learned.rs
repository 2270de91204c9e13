//! Free functions against ordinary parameters that say the same, and against differences of the right-hand side.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::plant::core::state;
use counterpoise_models::{
    Angles, Error, Excitation, FrictionLinearisation, LearnedElement, LearnedPlace, LearnedQuantity,
    OperatingPoint, Parameters, Plant, RegimeVariable, reference,
};

fn element(
    place: LearnedPlace,
    quantity: LearnedQuantity,
    variable: RegimeVariable,
    of: impl Fn(f64) -> f64,
) -> LearnedElement {
    let reach = if variable == RegimeVariable::Load { 5e3 } else { 2.0 };
    let points: Vec<f64> = (0..41).map(|k| reach * (f64::from(k) / 20.0 - 1.0)).collect();
    let values = points.iter().map(|x| of(*x)).collect();
    LearnedElement { values, ..LearnedElement::neutral(place, quantity, variable, points) }
}

/// A name, a free function, and the change of parameters that says the same.
type Pair = (&'static str, LearnedElement, fn(&mut Parameters));

/// Machines with a free function, and those whose parameters say the same.
fn pairs() -> Vec<Pair> {
    use LearnedPlace::{Gearbox, Motor, Pivot};
    use LearnedQuantity::{Damping, FrictionLevel, Stiffness, Torque, TorqueConstant};
    use RegimeVariable::{Angle, Control, Load, Rate, Time};
    let with_spring = |p: &mut Parameters| {
        let lumped = p.lumped.as_mut().unwrap();
        lumped.position_stiffness_nm_rad += 900.0;
        lumped.position_stiffness_centre_rad = -0.04;
    };
    vec![
        ("spring", element(Pivot, Torque, Angle, |x| -900.0 * (x + 0.04)), with_spring),
        ("viscous", element(Pivot, Torque, Rate, |w| -7.0 * w), |p| p.pivot_friction.viscous_nm_s_rad += 7.0),
        ("friction at the pivot", element(Pivot, FrictionLevel, Angle, |_| 1.3), |p| {
            p.pivot_friction.law.scale_coulomb(1.3);
        }),
        ("friction at the motor", element(Motor, FrictionLevel, Load, |_| 0.7), |p| {
            p.motor_friction.law.scale_coulomb(0.7);
        }),
        ("mesh", element(Gearbox, Stiffness, Load, |_| 0.8), |p| p.gearbox.stiffness_nm_rad *= 0.8),
        ("mesh damping", element(Gearbox, Damping, Time, |_| 1.5), |p| p.gearbox.damping_nm_s_rad *= 1.5),
        ("mesh torque", element(Gearbox, Torque, Angle, |x| 3e5 * x), |p| p.gearbox.stiffness_nm_rad += 3e5),
        ("damping at the motor", element(Motor, Damping, Rate, |_| 1.4), |p| {
            p.motor_friction.viscous_nm_s_rad *= 1.4;
        }),
        ("torque constant", element(Motor, TorqueConstant, Control, |_| 0.9), |p| {
            p.motor.torque_constant_nm_a *= 0.9;
        }),
    ]
}

fn two(element: &LearnedElement, same: fn(&mut Parameters)) -> [Plant; 2] {
    let mut rig = reference::rig();
    rig.gearbox.backlash_rad = 0.0; // a gap takes another stiffness than a torque does
    // back-EMF stays: the element is a factor on the torque alone
    let mut other = rig.clone();
    rig.learned.push(element.clone());
    same(&mut other);
    [&rig, &other].map(|p| Plant::from_lumped(p).unwrap())
}

fn close(a: &[f64], b: &[f64], scale: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9 * scale.max(b.abs()))
}

#[test]
fn a_free_function_and_the_parameter_that_says_the_same_are_one_machine() {
    for (name, element, same) in pairs() {
        let plants = two(&element, same);
        let point = OperatingPoint { hub_angle_rad: 0.15, platform_angle_rad: -0.05 };
        let rests = plants.each_ref().map(|plant| plant.equilibrium(&point));
        assert!((rests[0].control_v - rests[1].control_v).abs() < 1e-9, "{name}: {rests:?}");
        assert!(close(&rests[0].core_state, &rests[1].core_state, 1e-3), "{name}: {rests:?}");
        let slopes = plants.each_ref().map(|plant| {
            let mut x = plant.equilibrium(&point).core_state;
            x.resize(plant.order(), 0.0);
            (x[state::MOTOR], x[state::RATE], x[plant.core_order() + 1]) = (12.0, 0.07, 30.0);
            let mut dx = vec![0.0; x.len()];
            let at = Excitation {
                time_s: 0.4,
                control_v: 3.1,
                platform_angle_rad: -0.05,
                ..Excitation::default()
            };
            plant.derivative(&x, &at, &mut dx);
            dx
        });
        assert!(close(&slopes[0], &slopes[1], 1e-3), "{name}: {slopes:?}");
        let described =
            FrictionLinearisation::DescribingFunction { hub_amplitude_rad: 2e-3, frequency_rad_s: 20.0 };
        for friction in [FrictionLinearisation::Viscous, described] {
            let linear = [0, 1].map(|k| plants[k].linearise(&rests[k], friction, Angles::Keep).unwrap());
            let scale = linear[1].system.A.norm_max();
            assert!(
                close(linear[0].system.A.as_slice(), linear[1].system.A.as_slice(), 1e-3 * scale),
                "{name}"
            );
            assert!(close(linear[0].system.B.as_slice(), linear[1].system.B.as_slice(), 1.0), "{name}");
        }
    }
}

#[test]
fn the_linearisation_is_the_slope_of_a_curved_function() {
    let mut rig = reference::rig();
    rig.pivot_friction.law = counterpoise_models::FrictionLaw::None;
    rig.motor_friction.law = counterpoise_models::FrictionLaw::None;
    let wave = |x: f64| 400.0 * (3.0 * x).sin();
    rig.learned.push(element(LearnedPlace::Pivot, LearnedQuantity::Torque, RegimeVariable::Angle, wave));
    let plant = Plant::from_lumped(&rig).unwrap();
    let point = OperatingPoint { hub_angle_rad: 0.2, platform_angle_rad: 0.0 };
    let rest = plant.equilibrium(&point);
    let mut x = rest.core_state.clone();
    x.resize(plant.order(), 0.0);
    let slope = |angle: f64| {
        let mut moved = x.clone();
        moved[state::ANGLE] += angle;
        let mut dx = vec![0.0; x.len()];
        plant.derivative(&moved, &Excitation { control_v: rest.control_v, ..Excitation::default() }, &mut dx);
        dx[state::RATE]
    };
    assert!(slope(0.0).abs() < 1e-7, "at rest {}", slope(0.0));
    let expected = (slope(1e-5) - slope(-1e-5)) / 2e-5;
    let linear = plant.linearise(&rest, FrictionLinearisation::Viscous, Angles::Keep).unwrap();
    let row = linear.state_names.iter().position(|name| name == "rate_rad_s").unwrap();
    // the inertial angle moves the relative one with it
    let columns = ["angle_rad", "relative_hub_angle_rad"];
    let found: f64 = columns
        .iter()
        .map(|c| linear.system.A[(row, linear.state_names.iter().position(|name| name == c).unwrap())])
        .sum();
    assert!((found - expected).abs() < 1e-4 * expected.abs(), "{found} {expected}");
}

#[test]
fn what_has_no_meaning_is_refused_with_the_place_in_the_list() {
    use LearnedPlace::{Gearbox, Motor, Pivot};
    use LearnedQuantity::{FrictionLevel, Stiffness, Torque};
    use RegimeVariable::{Angle, Control, Turn};
    let good = |place, quantity, variable| element(place, quantity, variable, |_| 1.0);
    let short = LearnedElement { values: vec![1.0], ..good(Pivot, Torque, Angle) };
    let falls = LearnedElement { points: vec![0.0, 0.0], values: vec![1.0; 2], ..good(Pivot, Torque, Angle) };
    let negative =
        LearnedElement { points: vec![0.0], values: vec![-0.1], ..good(Pivot, FrictionLevel, Angle) };
    let cases = [
        (good(Gearbox, FrictionLevel, Angle), "learned[0].quantity"),
        (good(Motor, Stiffness, Angle), "learned[0].quantity"),
        (good(Motor, FrictionLevel, Control), "learned[0].variable"),
        (good(Gearbox, Torque, Turn), "learned[0].variable"),
        (good(Motor, Torque, Turn), "learned[0].points[0]"),
        (LearnedElement { points: Vec::new(), values: Vec::new(), ..short.clone() }, "learned[0].points"),
        (short, "learned[0].values"),
        (falls, "learned[0].points[1]"),
        (negative, "learned[0].values[0]"),
    ];
    for (element, expected) in cases {
        let mut rig = reference::rig();
        rig.learned.push(element);
        match Plant::from_lumped(&rig) {
            Err(Error::Parameter { parameter, .. }) => assert_eq!(parameter, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
    let mut rigid = reference::rig();
    (rigid.gearbox.stiffness_nm_rad, rigid.gearbox.backlash_rad) = (f64::INFINITY, 0.0);
    rigid.learned.push(good(Gearbox, Torque, Angle));
    assert!(Plant::from_lumped(&rigid).is_err());
}
