//! The two-mass servo on which other solvers are measured: motor, gear with backlash, load, three friction laws at
//! three stiffnesses, gyroscope, and a controller of order eleven at 1 kHz.
//!
//! ```text
//! two_mass_servo CONTROLLER_FILE FRICTION STIFFNESS TOLERANCE RUNS [LOG_FILE]
//! ```
//!
//! Friction 0 Dahl, 1 LuGre, 2 reset integrator; stiffness 0, 1, 2. Prints the fastest run as JSON; the log holds ten
//! doubles a sample: nine states and the control.

#![allow(non_snake_case)]

#[path = "../benches/two_mass/mod.rs"]
mod two_mass;

use counterpoise_simulate::{Detail, Scenario, Simulator, TimeHistory};
use std::error::Error;
use two_mass::{Controller, RATIO, VOLTS_PER_TORQUE, scenario};

fn log(history: &TimeHistory) -> Vec<u8> {
    let (t, mut bytes) = (&history.truth, Vec::new());
    for k in 0..history.len() {
        let relative = t.hub_angle_rad[k] - t.platform_angle_rad[k];
        let row = [
            RATIO * (t.wind_up_rad[k] + relative),
            t.motor_rate_rad_s[k],
            t.hub_angle_rad[k],
            t.hub_rate_rad_s[k],
            t.current_a[k],
            history.readings.hub_rate_rad_s[k],
            0.0,
            0.0,
            0.0,
            history.readings.control_v[k] / VOLTS_PER_TORQUE,
        ];
        bytes.extend(row.iter().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let argument =
        |k: usize| arguments.get(k).ok_or("CONTROLLER_FILE FRICTION STIFFNESS TOLERANCE RUNS [LOG_FILE]");
    let (law, stiffness) = (argument(2)?.parse()?, argument(3)?.parse()?);
    let (tolerance, runs): (f64, usize) = (argument(4)?.parse()?, argument(5)?.parse()?);
    let plant = two_mass::plant(law, stiffness)?;
    let full = scenario(&plant);
    let timed = Scenario { detail: Detail::Recording, ..full.clone() };
    let mut least = f64::INFINITY;
    for _ in 0..runs.max(1) {
        let mut controller = Controller::read(argument(1)?)?;
        let start = std::time::Instant::now();
        // the stored matrices are part of the time
        Simulator::with_tolerance(&plant, tolerance)?.run(&mut controller, &timed)?;
        least = least.min(start.elapsed().as_secs_f64());
    }
    let mut controller = Controller::read(argument(1)?)?;
    let history = Simulator::with_tolerance(&plant, tolerance)?.run(&mut controller, &full)?;
    let effort = history.effort;
    println!(
        "{{\"fric\": {law}, \"stiff\": {stiffness}, \"tolerance\": {tolerance:e}, \"cpu_s\": {least:.6}, \"steps\": {}, \"rejected\": {}, \"forced\": {}, \"iterations\": {}}}",
        effort.steps, effort.rejected, effort.forced, effort.iterations
    );
    if let Some(path) = arguments.get(6) {
        std::fs::write(path, log(&history))?;
    }
    Ok(())
}
