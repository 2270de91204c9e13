//! Surge on an elevated axis, linear and nonlinear, and the error budget of the line of sight.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use counterpoise_controller::signal::HUB_POSITION;
use counterpoise_controller::{Controller, Projection};
use counterpoise_models::plant::{OperatingPoint, Plant};
use counterpoise_models::{AccelerometerAxis, Friction, FrictionLaw, Parameters};
use counterpoise_recordings::Signals;
use counterpoise_verify::line_of_sight::SightAngles;
use counterpoise_verify::robustness::figures_of;
use counterpoise_verify::{
    Arrangement, Coincidence, ErrorSource, Limit, LineOfSight, MissingReason, Model, Optics,
    PerformanceFigure, Procedure, Quantity, Requirement, Road, RoadOrigin, SightFigure, Source, Value,
    Verdict, verify,
};
use support::{controller, rig};

const ELEVATION_RAD: f64 = 0.3;

/// Six seconds of heave, pitch and surge, one tone each.
fn road() -> Road {
    let sine = |amplitude: f64, hz: f64| -> Vec<f64> {
        (0..1201).map(|k| amplitude * (std::f64::consts::TAU * hz * f64::from(k) * 0.005).sin()).collect()
    };
    let still = [0.0; 1201];
    let (heave, pitch, surge) = (sine(0.5, 1.5), sine(0.005, 0.7), sine(2.0, 1.0));
    Road {
        origin: RoadOrigin::Recording("tones".to_owned()),
        sample_period_s: 0.005,
        signals: Signals::stack([&heave[..], &pitch, &surge, &still, &still]),
    }
}

/// The road without its surge.
fn without_surge(road: Road) -> Road {
    Road { signals: Signals::stack([road.heave_m_s2(), road.pitch_rate_rad_s()]), ..road }
}

fn procedure(road: Road) -> Procedure {
    Procedure {
        operating_point: OperatingPoint { hub_angle_rad: ELEVATION_RAD, platform_angle_rad: 0.0 },
        road: Some(road),
        duration_s: 3.0,
        ..Procedure::default()
    }
}

/// A machine without friction and backlash: the linear plant is the nonlinear one but for small terms.
fn smooth(axis: AccelerometerAxis) -> Parameters {
    let mut p = rig();
    let (motor, pivot) = (p.motor_friction.viscous_nm_s_rad, p.pivot_friction.viscous_nm_s_rad);
    (p.motor_friction, p.pivot_friction) = (
        Friction::with_viscous_part(FrictionLaw::None, motor),
        Friction::with_viscous_part(FrictionLaw::None, pivot),
    );
    p.gearbox.backlash_rad = 0.0;
    p.sensors.accelerometer_axis = axis;
    p
}

/// A static feedforward of the accelerometer as it stands.
fn fitting(axis: AccelerometerAxis) -> Controller {
    let share = match axis {
        AccelerometerAxis::Vertical => ELEVATION_RAD.cos(),
        AccelerometerAxis::Elevated => 1.0,
    };
    controller().with(|parts| parts.paths[1].system.D = parts.paths[1].system.D.scale(share)).unwrap()
}

fn hub_rms(axis: AccelerometerAxis, model: Model, road: Road) -> f64 {
    let plant = Plant::from_lumped(&smooth(axis)).unwrap();
    let found = verify(&plant, &fitting(axis), &procedure(road), &[]).unwrap();
    let figure =
        PerformanceFigure::Disturbance(model, Source::Road, Arrangement::Compensated, Quantity::HubRms);
    found.verification().value(figure).unwrap()
}

#[test]
fn the_linear_loop_meets_surge_as_the_nonlinear_one_does() {
    for axis in [AccelerometerAxis::Vertical, AccelerometerAxis::Elevated] {
        let (linear, nonlinear) =
            (hub_rms(axis, Model::Linear, road()), hub_rms(axis, Model::Nonlinear, road()));
        assert!((linear / nonlinear - 1.0).abs() < 0.1, "{axis:?}: {linear} {nonlinear}");
    }
}

#[test]
fn an_elevated_accelerometer_takes_surge_out() {
    let still = without_surge(road());
    let of = |axis, road: &Road| hub_rms(axis, Model::Nonlinear, road.clone());
    let none = of(AccelerometerAxis::Vertical, &still);
    let (upright, elevated) =
        (of(AccelerometerAxis::Vertical, &road()), of(AccelerometerAxis::Elevated, &road()));
    assert!(upright > 3.0 * none && elevated < 1.3 * none, "{none} {upright} {elevated}");
}

/// Accelerometers of heave and surge on the platform, which the controller projects across the beam by the hub's angle.
fn projected_figure(model: Model, elevation_rad: f64, road: Road) -> f64 {
    let mut p = smooth(AccelerometerAxis::Vertical);
    // 2 rad at the end of the converter: the rig's own resolver ends at 0.5 rad
    p.sensors.hub_resolver.iter_mut().for_each(|resolver| resolver.scale_v_unit = 5.0);
    p.sensors.surge_accelerometer = Some(p.sensors.platform_accelerometer.clone());
    let projection = Projection {
        design_angle_rad: elevation_rad,
        angle_reading: Some(HUB_POSITION),
        pitch_washout_s: Some(10.0),
    };
    let acting = controller().with(|parts| parts.projection = Some(projection)).unwrap();
    let operating_point = OperatingPoint { hub_angle_rad: elevation_rad, platform_angle_rad: 0.0 };
    let asked = Procedure { operating_point, ..procedure(road) };
    let found = verify(&Plant::from_lumped(&p).unwrap(), &acting, &asked, &[]).unwrap();
    let figure =
        PerformanceFigure::Disturbance(model, Source::Road, Arrangement::Compensated, Quantity::HubRms);
    found.verification().value(figure).unwrap()
}

#[test]
fn two_accelerometers_projected_by_the_hubs_angle_take_surge_out_at_every_elevation() {
    let still = without_surge(road());
    for elevation_rad in [0.0, 5.0_f64.to_radians(), 15.0_f64.to_radians(), 40.0_f64.to_radians()] {
        let none = projected_figure(Model::Nonlinear, elevation_rad, still.clone());
        let with = projected_figure(Model::Nonlinear, elevation_rad, road());
        assert!(with < 1.3 * none, "{elevation_rad}: {none} {with}");
        let linear = projected_figure(Model::Linear, elevation_rad, road());
        assert!((linear / with - 1.0).abs() < 0.15, "{elevation_rad}: {linear} {with}");
    }
}

#[test]
fn a_sweep_has_surge_in_its_linear_figures() {
    for axis in [AccelerometerAxis::Vertical, AccelerometerAxis::Elevated] {
        let plant = Plant::from_lumped(&smooth(axis)).unwrap();
        for arrangement in [Arrangement::Uncontrolled, Arrangement::Feedback, Arrangement::Compensated] {
            let figure =
                PerformanceFigure::Disturbance(Model::Linear, Source::Road, arrangement, Quantity::HubRms);
            let found = figures_of(&plant, &fitting(axis), &procedure(road()), &[figure]).unwrap();
            let whole = verify(&plant, &fitting(axis), &procedure(road()), &[]).unwrap();
            let wanted = Value::Is(whole.verification().value(figure).unwrap());
            assert_eq!(found[0], wanted, "{axis:?} {arrangement:?}");
        }
    }
}

#[test]
fn the_error_budget_adds_up_to_the_simulated_error() {
    let plant = Plant::from_lumped(&rig()).unwrap();
    let asked = Procedure { line_of_sight: Some(LineOfSight::default()), ..procedure(road()) };
    let figure = PerformanceFigure::Sight(SightFigure::Hub);
    let limit = [Requirement::new(figure, Limit::AtMost(1.0)).unwrap()];
    let verified = verify(&plant, &controller(), &asked, &limit).unwrap();
    let found = verified.verification();
    let budget = found.error_budget.as_ref().unwrap();
    assert!(matches!(found.verdicts[0].1, Verdict::Holds { .. }), "{:?}", found.verdicts);
    assert_eq!(found.value(figure), Some(budget.total_rad[0]));
    for (sum, total) in budget.sum_rad().iter().zip(budget.total_rad) {
        assert!((sum / total - 1.0).abs() < 1e-9, "{sum} {total}");
    }
    let share =
        |source| budget.contributions.iter().find(|one| one.source == source).map(|one| one.share_rad2[0]);
    assert_eq!(share(ErrorSource::Roll), None, "this base does not roll");
    assert!(share(ErrorSource::Surge).unwrap() > 0.2 * budget.total_rad[0].powi(2), "{budget:?}");
    assert!(share(ErrorSource::HubGyro).unwrap().abs() < 0.1 * budget.total_rad[0].powi(2), "{budget:?}");
}

/// Coincidence, hits and blur are measured where their sections are, and a requirement that asks for one without its section says so.
#[test]
fn gunner_and_observer_get_their_figures() {
    let plant = Plant::from_lumped(&rig()).unwrap();
    let coincidence =
        Coincidence { window_rad: 1e-3, delay_s: 0.01, target_rad: 1.5e-3, dispersion_rad: 2e-4 };
    let sight = LineOfSight {
        settle_s: Some(2.5),
        coincidence: Some(coincidence),
        optics: Some(Optics { focal_length_m: 0.1, spatial_frequency_m: 3e4 }),
        ..LineOfSight::default()
    };
    let of = |sight: LineOfSight| {
        let asked = Procedure { line_of_sight: Some(sight), ..procedure(road()) };
        let limit =
            [Requirement::new(PerformanceFigure::Sight(SightFigure::Hit), Limit::AtLeast(0.0)).unwrap()];
        verify(&plant, &controller(), &asked, &limit).unwrap().into_parts().1
    };
    let found = of(sight);
    let value = |figure| found.value(PerformanceFigure::Sight(figure)).unwrap();
    assert!(matches!(found.verdicts[0].1, Verdict::Holds { .. }), "{:?}", found.verdicts);
    let history = found
        .history(
            Model::Nonlinear,
            counterpoise_verify::line_of_sight::sight_experiment(&found.evidence.procedure),
        )
        .unwrap();
    let angles = SightAngles::of(history, 2.5).unwrap();
    let inside = angles.hub_rad.iter().filter(|error| error.abs() <= 1e-3).count();
    assert_eq!(value(SightFigure::Coincidence), inside as f64 / angles.hub_rad.len() as f64);
    assert!((0.05..0.999).contains(&value(SightFigure::Coincidence)), "{}", value(SightFigure::Coincidence));
    assert!((0.0..=1.0).contains(&value(SightFigure::Hit)) && value(SightFigure::Wait) > 0.0);
    // motion within an exposure that is small beside a period of detail takes 2 (pi f F)^2 times its mean square
    let small = 2.0 * (std::f64::consts::PI * 3e4 * 0.1 * value(SightFigure::HubJitter)).powi(2);
    assert!((value(SightFigure::HubTransferLoss) / small - 1.0).abs() < 0.1, "{small}");
    assert!(value(SightFigure::Bending) < value(SightFigure::Tip));
    let larger = Coincidence { target_rad: 3e-3, ..coincidence };
    let easier = of(LineOfSight { coincidence: Some(larger), ..sight });
    assert!(easier.value(PerformanceFigure::Sight(SightFigure::Hit)).unwrap() > value(SightFigure::Hit));
    let without = of(LineOfSight { coincidence: None, ..sight });
    let Verdict::NotApplicable { why } = &without.verdicts[0].1 else { panic!("{:?}", without.verdicts) };
    assert_eq!(*why, MissingReason::NoCoincidence);
}

#[test]
fn a_shot_that_leaves_after_the_end_is_refused() {
    let coincidence = Coincidence { delay_s: 4.5, ..Coincidence::default() };
    let sight = LineOfSight { coincidence: Some(coincidence), ..LineOfSight::default() };
    let asked = Procedure { line_of_sight: Some(sight), ..procedure(road()) };
    assert!(asked.check().unwrap_err().to_string().contains("delay of the shot"));
    let late = LineOfSight { settle_s: Some(6.5), ..LineOfSight::default() };
    let asked = Procedure { line_of_sight: Some(late), ..procedure(road()) };
    assert!(asked.check().unwrap_err().to_string().contains("settling time of the line of sight"));
}

/// Without anything that is nonlinear, sources that do not move together superpose.
#[test]
fn in_a_linear_loop_the_sources_superpose() {
    let plant = Plant::from_lumped(&smooth(AccelerometerAxis::Vertical)).unwrap();
    let asked = Procedure { line_of_sight: Some(LineOfSight::default()), ..procedure(road()) };
    let verified = verify(&plant, &fitting(AccelerometerAxis::Vertical), &asked, &[]).unwrap();
    let budget = verified.verification().error_budget.as_ref().unwrap();
    let (superposed, total) = (budget.superposed_rad()[0], budget.total_rad[0]);
    assert!((superposed / total - 1.0).abs() < 0.1, "{superposed} {total}");
}

#[test]
fn nobody_pays_for_a_budget_that_nobody_asks_for() {
    let plant = Plant::from_lumped(&smooth(AccelerometerAxis::Vertical)).unwrap();
    let limit = [Requirement::new(PerformanceFigure::Sight(SightFigure::Hub), Limit::AtMost(1.0)).unwrap()];
    let verified = verify(&plant, &controller(), &procedure(road()), &limit).unwrap();
    let found = verified.verification();
    assert_eq!(
        (found.error_budget.as_ref(), found.value(PerformanceFigure::Sight(SightFigure::Hub))),
        (None, None)
    );
    let Verdict::NotApplicable { why } = &found.verdicts[0].1 else { panic!("{:?}", found.verdicts) };
    assert_eq!(*why, MissingReason::NoLineOfSight);
}
