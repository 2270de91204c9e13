//! Ten seconds of the reference rig's closed loop, shaken and with noisy sensors: how long it takes.

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::{Plant, reference};
use counterpoise_simulate::{
    Detail, Error, Imperfections, PlatformMotion, Scenario, Signal, Simulator, Sine,
};

/// Runs that are timed; the fastest is told.
const RUNS: u64 = 200;

fn main() -> Result<(), Error> {
    let sine = |amplitude, frequency_rad_s| Sine { amplitude, frequency_rad_s, phase_rad: 0.0 };
    let scenario = |seed| Scenario {
        demand_rad_s: Signal::Triangle { amplitude: 0.1, period_s: 1.0 },
        platform: PlatformMotion {
            pitch_rate_rad_s: Signal::Sines(vec![sine(0.1, 8.0), sine(0.03, 25.0)]),
            heave_m_s2: Signal::Sines(vec![sine(2.0, 13.0)]),
            initial_angle_rad: 0.0,
        },
        imperfections: Imperfections::NoiseAndQuantisation { seed },
        detail: Detail::Recording,
        ..Scenario::still(10.0)
    };
    let mut simulator = Simulator::new(&Plant::lumped(&reference::rig())?)?;
    let mut least = f64::INFINITY;
    for seed in 0..RUNS {
        let mut controller = ProportionalIntegral {
            kp_v_s_rad: 18.0,
            ki_v_rad: 80.0,
            bias_v: 2.88,
            sample_period_s: 1e-3,
            integral_v: 0.0,
        };
        let start = std::time::Instant::now();
        let history = simulator.run(&mut controller, &scenario(seed))?;
        least = least.min(start.elapsed().as_secs_f64());
        if seed == 0 {
            println!("{:?}", history.effort);
        }
    }
    println!("10 s in {:.2} ms: {:.0} times real time", 1e3 * least, 10.0 / least);
    Ok(())
}
