//! A hydraulic cylinder with a servo valve: the textbook's resonance, the slopes of the valve, and the linear plant as the slope of the definition.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use counterpoise_models::parameters::cylinder::Lever;
use counterpoise_models::plant::core::state;
use counterpoise_models::{
    Angles, Excitation, Friction, FrictionLaw, FrictionLinearisation, LinearPlant, Linkage, LumpedStructure,
    OperatingPoint, Parameters, Plant, reference,
};

const PINS: Linkage = Linkage { arm_m: 0.6, arm_angle_rad: -0.3, anchor_m: 1.3, anchor_angle_rad: -1.7 };

fn machine(lever: Lever, valve_rad_s: f64) -> Parameters {
    let mut p = reference::rig();
    let none = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    (p.motor_friction, p.pivot_friction) = (none.clone(), none);
    (p.beam, p.lumped) =
        (None, Some(LumpedStructure { out_of_balance_kg_m: 900.0, ..LumpedStructure::rigid(2.5e3) }));
    p.configurations.clear();
    reference::put_cylinder(&mut p, lever);
    p.amplifier.time_constant_s = 1.6 / valve_rad_s;
    let cylinder = p.cylinder.as_mut().unwrap();
    (cylinder.overlap_l_s, cylinder.valve_frequency_rad_s) = (0.01, valve_rad_s);
    p
}

#[test]
fn the_oil_springs_at_the_frequency_of_the_textbook() {
    let mut p = machine(Lever::Constant(0.5), 400.0);
    p.gravity_m_s2 = 0.0;
    p.motor.resistance_ohm = 1e-9;
    let plant = Plant::from_lumped(&p).unwrap();
    let at = plant.equilibrium(&OperatingPoint::default());
    let linear = plant.linearise(&at, FrictionLinearisation::Viscous, Angles::Drop).unwrap();
    // sqrt(4 b A^2 r^2/(V J)) in SI: H. Merritt 1967, equation 6-26
    let expected = (4.0 * 800e6 * (2.5e-3_f64 * 0.5).powi(2) / (2e-3 * 2.5e3)).sqrt();
    let poles = counterpoise_lti::poles(&linear.system).unwrap();
    let nearest = poles.iter().map(|pole| (pole.norm() / expected - 1.0).abs()).fold(f64::INFINITY, f64::min);
    assert!(nearest < 1e-9, "{expected}: {poles:?}");
    let spool = poles.iter().map(|pole| (pole.norm() / 400.0 - 1.0).abs()).fold(f64::INFINITY, f64::min);
    assert!(spool < 1e-9, "{poles:?}");
}

#[test]
fn a_valve_passes_what_its_opening_asks_for_and_its_slopes_are_those_of_the_flow() {
    let cylinder = machine(Lever::Constant(0.5), 400.0).cylinder.unwrap();
    for (flow, pressure) in [(0.3, 6.0), (-0.2, 6.0), (0.1, -12.0), (0.01, 19.0)] {
        let opening = cylinder.opening_l_s(flow, pressure);
        assert!((cylinder.flow_l_s(opening, pressure) / flow - 1.0).abs() < 1e-12);
        let slopes = cylinder.valve_slopes(opening, pressure);
        let h = 1e-6;
        let over = |o: f64, p: f64| {
            (cylinder.flow_l_s(opening + o, pressure + p) - cylinder.flow_l_s(opening - o, pressure - p))
                / (2.0 * h)
        };
        assert!((over(h, 0.0) / slopes.flow_gain - 1.0).abs() < 1e-6);
        assert!((over(0.0, h) / -slopes.pressure_l_s_mpa - 1.0).abs() < 1e-6);
    }
    assert_eq!(cylinder.flow_l_s(0.009, 5.0), 0.0, "within the overlap");
    assert_eq!(cylinder.opening_l_s(0.1, 20.0), f64::INFINITY, "a load at the supply's pressure");
    assert!(cylinder.flow_l_s(0.5, 25.0) < 0.0, "a load above the supply drives the flow back");
}

#[test]
fn a_linkage_s_lever_is_the_slope_of_its_travel() {
    let lever = Lever::Linkage(PINS);
    let pulling = Lever::Linkage(Linkage { anchor_angle_rad: 1.9, arm_angle_rad: 0.2, ..PINS });
    for lever in [lever, pulling] {
        for angle in [-0.4, 0.0, 0.3, 0.7] {
            let h = 1e-5;
            let [before, at, after] = [angle - h, angle, angle + h].map(|a| lever.at(a));
            assert!(((after.travel_m - before.travel_m) / (2.0 * h) - at.arm_m).abs() < 1e-9);
            assert!(((after.arm_m - before.arm_m) / (2.0 * h) - at.slope_m_rad).abs() < 1e-8);
        }
        assert!(lever.at(0.0).arm_m > 0.0 && lever.at(0.0).travel_m == 0.0);
    }
}

#[test]
fn the_linear_plant_is_the_slope_of_the_definition() {
    for angle in [-0.2, 0.0, 0.5] {
        let plant = Plant::from_lumped(&machine(Lever::Linkage(PINS), 400.0)).unwrap();
        let at = plant.equilibrium(&OperatingPoint { hub_angle_rad: angle, platform_angle_rad: 0.0 });
        let linear = plant.linearise(&at, FrictionLinearisation::Viscous, Angles::Keep).unwrap();
        let places = [state::VOLTAGE, state::CURRENT, state::MOTOR, state::ANGLE, state::RATE];
        let mut rest = at.core_state.clone();
        rest.resize(plant.order(), 0.0);
        let slope = |x: &[f64], control_v: f64| {
            let mut dx = vec![0.0; x.len()];
            plant.derivative(x, &Excitation { control_v, ..Excitation::default() }, &mut dx);
            dx
        };
        let still = slope(&rest, at.control_v);
        assert!(still.iter().all(|d| d.abs() < 1e-9), "{still:?}");
        let A = &linear.system.A;
        let cylinder = plant.parameters().cylinder.as_ref().unwrap();
        let slopes = cylinder.valve_slopes(at.core_state[state::VOLTAGE], at.current_a);
        for (j, &place) in places.iter().enumerate() {
            let h = 1e-6 * rest[place].abs().max(1.0);
            let moved = |by: f64| {
                let mut x = rest.clone();
                x[place] += by;
                slope(&x, at.control_v)
            };
            let (up, down) = (moved(h), moved(-h));
            for (i, &row) in places.iter().enumerate() {
                // the angle of the hub moves its angle on the platform too, the last state
                let expected = A[(i, j)] + if place == state::ANGLE { A[(i, 5)] } else { 0.0 };
                // the linear state is the flow that the opening passes
                let scaled = row == state::CURRENT && place == state::VOLTAGE;
                let found = (up[row] - down[row]) / (2.0 * h) / if scaled { slopes.flow_gain } else { 1.0 };
                let scale = A.row_vec(i).iter().fold(1e-6_f64, |most, entry| most.max(entry.abs()));
                assert!((found - expected).abs() < 1e-5 * scale, "{angle} {row} {place}: {found} {expected}");
            }
        }
        let (up, down) = (slope(&rest, at.control_v + 1e-3), slope(&rest, at.control_v - 1e-3));
        let found = (up[state::MOTOR] - down[state::MOTOR]) / 2e-3;
        let gain = linear.system.B[(2, LinearPlant::CONTROL)];
        assert!((found * slopes.flow_gain / gain - 1.0).abs() < 1e-6, "{found} {gain}");
    }
}

#[test]
fn what_only_a_motor_has_is_refused_beside_a_cylinder() {
    let refused = |change: fn(&mut Parameters)| {
        let mut p = machine(Lever::Constant(0.5), 400.0);
        change(&mut p);
        Plant::from_lumped(&p).unwrap_err().to_string()
    };
    assert!(refused(|p| p.motor.inertia_kg_m2 = 1.0).contains("motor.inertia_kg_m2"));
    assert!(refused(|p| p.drive_limits.supply_power_w = 1e3).contains("drive_limits"));
    assert!(refused(|p| p.amplifier.input_limit_v = f64::INFINITY).contains("amplifier.input_limit_v"));
    assert!(
        refused(|p| p.motor_friction.law = FrictionLaw::Coulomb { coulomb_nm: 10.0 })
            .contains("motor_friction")
    );
    assert!(refused(|p| p.cylinder.as_mut().unwrap().supply_mpa = 0.0).contains("cylinder.supply_mpa"));
    assert!(refused(|p| p.cylinder.as_mut().unwrap().lever = Lever::Constant(0.4)).contains("gearbox.ratio"));
}
