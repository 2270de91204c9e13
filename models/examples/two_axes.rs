//! Reads motions of a traverse ring with an elevated body from standard input, one a line of numbers, and prints the torques that the equations of the
//! product need about the elevation axis and about the traverse axis. `tests/peers/base_motion/two_axes.py` compares them with Lagrange's.

use counterpoise_models::plant::SinCos;
use counterpoise_models::two_axes::{BodyInertia, ElevatedBody, ElevationMotion, PivotPosition, RingMotion};
use std::io::{BufRead, Write};

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let x: Vec<f64> = line?.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        if x.len() != 24 {
            return Err(std::io::Error::other(format!("a line has {} numbers instead of 24", x.len())));
        }
        let inertia = BodyInertia {
            about_axis_kg_m2: x[2],
            about_beam_kg_m2: x[3],
            about_normal_kg_m2: x[4],
            product_kg_m2: x[5],
        };
        let body = ElevatedBody {
            out_of_balance_kg_m: x[0],
            vertical_offset_kg_m: x[1],
            inertia,
            pivot: PivotPosition { forward_m: x[6], left_m: x[7] },
            included_at: SinCos::of(x[8]),
        };
        let ring = RingMotion {
            specific_force_m_s2: [x[9], x[10], x[11]],
            rate_rad_s: [x[12], x[13], x[14]],
            acceleration_rad_s2: [x[15], x[16], x[17]],
        };
        let elevation =
            ElevationMotion { tilt: SinCos::of(x[18]), rate_rad_s: x[19], acceleration_rad_s2: x[20] };
        // what the traverse axis' own parameters say: inertia, first moments forward and to the left
        let [forward, left, _] = ring.specific_force_m_s2;
        let own = x[21] * ring.acceleration_rad_s2[2] + x[22] * left - x[23] * forward;
        let traverse = own - body.torque_on_traverse_nm(&ring, &elevation);
        writeln!(out, "{:e} {traverse:e}", elevation_torque_nm(&body, &ring, &elevation))?;
    }
    Ok(())
}

/// Returns the torque about the elevation axis that the plant's equation needs: inertia, out-of-balance, and rates about the other axes.
fn elevation_torque_nm(body: &ElevatedBody, ring: &RingMotion, elevation: &ElevationMotion) -> f64 {
    let SinCos { sin, cos } = elevation.tilt;
    let [surge, _, heave] = body.specific_force_at_pivot(ring);
    let rates = ElevatedBody::off_axis_rates(ring, elevation.tilt);
    let slender = body.inertia.about_axis_kg_m2;
    let gyroscopic = -slender * rates[0] * rates[1] + body.inertia.torque_beside_slender_nm(slender, rates);
    let load = body.out_of_balance_kg_m * (heave * cos - surge * sin)
        - body.vertical_offset_kg_m * (heave * sin + surge * cos);
    slender * elevation.acceleration_rad_s2 + load - gyroscopic
}
