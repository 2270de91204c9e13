//! Replays readings through the controller of the crate `axis`: seven doubles a sample in, one double out, in the machine's
//! own byte order. A sample whose first reading is no number starts the controller anew.
extern crate axis;

use std::io::{BufReader, BufWriter, Read, Write};

use axis::{Controller, Readings, Real};

fn main() -> std::io::Result<()> {
    let (mut from, mut to) = (BufReader::new(std::io::stdin()), BufWriter::new(std::io::stdout()));
    let mut controller = Controller::new();
    let mut bytes = [0u8; 56];
    while from.read_exact(&mut bytes).is_ok() {
        let mut v = [0.0f64; 7];
        for (value, chunk) in v.iter_mut().zip(bytes.chunks_exact(8)) {
            let mut eight = [0u8; 8];
            eight.copy_from_slice(chunk);
            *value = f64::from_ne_bytes(eight);
        }
        let mut out = 0.0;
        if v[0].is_nan() {
            controller = Controller::new();
        } else {
            out = f64::from(controller.step(&Readings {
                demand_rad_s: v[0] as Real,
                hub_rate_rad_s: v[1] as Real,
                platform_rate_rad_s: v[2] as Real,
                platform_accel_m_s2: v[3] as Real,
                motor_rate_rad_s: v[4] as Real,
                hub_position_rad: v[5] as Real,
                platform_surge_m_s2: v[6] as Real,
            }));
        }
        to.write_all(&out.to_ne_bytes())?;
    }
    to.flush()
}
