//! Ten seconds of the rig's closed loop with more and more modes: what a mode costs.

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::plant::{Body, BodyMode};
use counterpoise_models::{OperatingPoint, Plant, reference};
use counterpoise_simulate::{Detail, Error, PlatformMotion, Scenario, Signal, Simulator};

/// Runs that are timed; the fastest is told.
const RUNS: usize = 30;

fn main() -> Result<(), Error> {
    for modes in [1, 3, 14, 40_u32] {
        let rig = reference::rig();
        let Some(lumped) = rig.lumped.as_ref() else { continue };
        let mut body = Body::lumped(lumped);
        body.modes.extend((2..=modes).map(|k| BodyMode {
            frequency_rad_s: 240.0 * f64::from(k * k),
            damping_ratio: 0.01,
            hub_shape: 0.05 / f64::from(k),
            tip_shape: -0.05,
            load_share_kg_m: 0.1 / f64::from(k),
        }));
        let plant = Plant::with_body(&rig, body)?;
        let bias_v = plant.equilibrium(&OperatingPoint::default()).control_v;
        let mut controller = ProportionalIntegral {
            kp_v_s_rad: 18.0,
            ki_v_rad: 80.0,
            bias_v,
            sample_period_s: 1e-3,
            integral_v: 0.0,
        };
        let scenario = Scenario {
            demand_rad_s: Signal::Triangle { amplitude: 0.1, period_s: 1.0 },
            platform: PlatformMotion { pitch_rate_rad_s: Signal::sine(0.1, 8.0), ..PlatformMotion::STILL },
            detail: Detail::Recording,
            ..Scenario::still(10.0)
        };
        let (mut least, mut ready) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..RUNS {
            let start = std::time::Instant::now();
            let mut simulator = Simulator::new(&plant)?;
            simulator.run(&mut controller, &Scenario { duration_s: 1e-3, ..scenario.clone() })?;
            ready = ready.min(start.elapsed().as_secs_f64());
            controller.integral_v = 0.0;
            let start = std::time::Instant::now();
            simulator.run(&mut controller, &scenario)?;
            least = least.min(start.elapsed().as_secs_f64());
            controller.integral_v = 0.0;
        }
        println!("{modes:3} modes, {:3} states: {:6.2} ms, and {:6.2} ms to make the matrices", 6 + 2 * modes, 1e3 * least, 1e3 * ready);
    }
    Ok(())
}
