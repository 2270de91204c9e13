//! Roads of ISO 8608 through a vehicle that heaves and pitches.
//!
//! The profile has the displacement spectrum G(n) = G(n0) (n / n0)^-2, n in cycles/m, n0 = 0.1 cycles/m. It is a sum of sines with
//! random phases, so that the vehicle's steady motion is that sum through its frequency response: nothing is integrated.

use std::f64::consts::TAU;

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{Response, StateSpace, Timebase};
use counterpoise_models::base_motion::Traverse;
use counterpoise_recordings::Signals;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::filter::from_rest;
use super::four_wheels::{coherence_function, roll_dynamics};
use super::six_axes::{BaseSeries, felt_road, phases};
use super::vehicle::Vehicle;
use crate::{Error, Road, RoadOrigin};

pub use crate::road_class::RoadClass;

/// A drive over a road.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadDrive {
    /// Roughness of the road.
    pub class: RoadClass,
    /// Speed of the vehicle, m/s.
    pub speed_m_s: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// Period of the samples, s.
    pub sample_period_s: f64,
    /// Time in which the motion fades in and out, s.
    pub fade_s: f64,
    /// Seed of the phases.
    pub seed: u64,
}

/// Spatial frequencies that ISO 8608 reports, cycles/m.
const BAND: (f64, f64) = (0.011, 2.83);
const REFERENCE: f64 = 0.1;
const SINES: usize = 400;
/// Stream of the phases of half the difference of the two tracks.
const DIFFERENCE_STREAM: u64 = 48;

impl RoadClass {
    /// Returns the geometric mean of the class's G(n0), m^3.
    pub fn roughness_m3(self) -> f64 {
        let step = match self {
            RoadClass::A => 0,
            RoadClass::B => 1,
            RoadClass::C => 2,
            RoadClass::D => 3,
            RoadClass::E => 4,
        };
        16e-6 * 4f64.powi(step)
    }

    /// Returns the class with a letter A to E.
    pub fn from_letter(letter: &str) -> Option<Self> {
        let all = [("A", Self::A), ("B", Self::B), ("C", Self::C), ("D", Self::D), ("E", Self::E)];
        all.into_iter().find(|row| row.0.eq_ignore_ascii_case(letter)).map(|row| row.1)
    }
}

/// One sine of the profile.
#[derive(Debug, Clone, Copy)]
struct Tone {
    rate_rad_s: f64,
    amplitude_m: f64,
    phase_rad: f64,
}

/// Returns the motion of the mechanism's pivot during a drive: heave (m/s^2) and pitch rate (rad/s, nose-up), from rest to rest. A vehicle with
/// two sides also rolls, and the elevation axis feels gravity's share of that.
///
/// # Errors
/// [`Error::Range`] for a speed, duration or period that is not positive, and a vehicle without mass.
pub fn iso_road(drive: RoadDrive, vehicle: Vehicle, gravity_m_s2: f64) -> Result<Road, Error> {
    check(drive, vehicle)?;
    let origin = RoadOrigin::IsoRoad { class: drive.class, speed_m_s: drive.speed_m_s };
    let tones = profile(drive);
    let Some(sides) = vehicle.sides else {
        let [heave_m_s2, pitch_rate_rad_s] = motion(drive, vehicle, &dynamics(vehicle)?, &tones)?;
        let sample_period_s = drive.sample_period_s;
        return Ok(Road {
            origin,
            sample_period_s,
            signals: Signals::stack([&heave_m_s2[..], &pitch_rate_rad_s]),
        });
    };
    let shared = |tone: &Tone| coherence_function(tone.rate_rad_s / drive.speed_m_s * sides.track_m);
    let scaled = |tone: &Tone, share: f64, phase_rad: f64| Tone {
        amplitude_m: share.max(0.0).sqrt() * tone.amplitude_m,
        phase_rad,
        ..*tone
    };
    let common: Vec<Tone> =
        tones.iter().map(|tone| scaled(tone, 0.5 * (1.0 + shared(tone)), tone.phase_rad)).collect();
    let own = phases(drive.seed, DIFFERENCE_STREAM);
    let difference: Vec<Tone> =
        tones.iter().zip(own).map(|(tone, phase)| scaled(tone, 0.5 * (1.0 - shared(tone)), phase)).collect();
    let [heave, pitch_rate] = motion(drive, vehicle, &dynamics(vehicle)?, &common)?;
    let [roll_rate, roll_acceleration] =
        motion(drive, vehicle, &roll_dynamics(vehicle, sides)?, &difference)?;
    let mut series = BaseSeries::at_rest(heave.len(), drive.sample_period_s);
    for k in 0..heave.len() {
        let sway = -sides.pivot_height_m * roll_acceleration[k];
        series.set(k, [0.0, sway, heave[k], roll_rate[k], pitch_rate[k], 0.0]);
    }
    Ok(felt_road(origin, &series, Traverse::default(), gravity_m_s2))
}

/// The two outputs of a system from the road under the front and the rear axle, over time.
fn motion(
    drive: RoadDrive,
    vehicle: Vehicle,
    system: &StateSpace,
    tones: &[Tone],
) -> Result<[Vec<f64>; 2], Error> {
    let rates: Vec<f64> = tones.iter().map(|tone| tone.rate_rad_s).collect();
    let response = Response::of(system)?.at_all(&rates)?;
    let delay_s = 2.0 * vehicle.half_base_m / drive.speed_m_s;
    let through = |k: usize, output: usize| {
        let rear = C64::from_polar(1.0, -rates[k] * delay_s);
        let axles = response[k][(output, 0)] + response[k][(output, 1)] * rear;
        axles * C64::from_polar(tones[k].amplitude_m, tones[k].phase_rad)
    };
    let samples = (drive.duration_s / drive.sample_period_s).round() as usize + 1;
    let series = |output: usize| {
        let phasors: Vec<C64> = (0..rates.len()).map(|k| through(k, output)).collect();
        let at = |time_s: f64| {
            phasors
                .iter()
                .zip(&rates)
                .map(|(p, w)| p.re * (w * time_s).cos() - p.im * (w * time_s).sin())
                .sum()
        };
        let motion: Vec<f64> = (0..samples).map(|k| at(k as f64 * drive.sample_period_s)).collect();
        from_rest(&motion, drive.sample_period_s, drive.fade_s)
    };
    Ok([series(0), series(1)])
}

/// Checks a vehicle and its speed, m/s, without realising its motion.
///
/// # Errors
/// [`Error::Range`] for a speed, mass, inertia or stiffness that is not positive, and those of the vehicle's state-space systems.
pub fn check_vehicle(speed_m_s: f64, vehicle: Vehicle) -> Result<(), Error> {
    for (what, value) in [
        ("speed in m/s", speed_m_s),
        ("mass of the vehicle in kg", vehicle.body_mass_kg),
        ("pitch inertia of the vehicle in kg m^2", vehicle.pitch_inertia_kg_m2),
        ("mass of an axle in kg", vehicle.axle_mass_kg),
        ("tyre stiffness in N/m", vehicle.tyre_n_m),
        ("track in m", vehicle.sides.map_or(1.0, |sides| sides.track_m)),
        ("roll inertia in kg m^2", vehicle.sides.map_or(1.0, |sides| sides.roll_inertia_kg_m2)),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(Error::Range { what, value, allowed: "positive" });
        }
    }
    dynamics(vehicle)?;
    vehicle.sides.map_or(Ok(()), |sides| roll_dynamics(vehicle, sides).map(drop))
}

fn check(drive: RoadDrive, vehicle: Vehicle) -> Result<(), Error> {
    check_vehicle(drive.speed_m_s, vehicle)?;
    for (what, value) in [("duration in s", drive.duration_s), ("sample period in s", drive.sample_period_s)]
    {
        if !(value > 0.0 && value.is_finite()) {
            return Err(Error::Range { what, value, allowed: "positive" });
        }
    }
    Ok(())
}

/// Sines at logarithmically spaced frequencies, each with the variance of its band.
fn profile(drive: RoadDrive) -> Vec<Tone> {
    let mut source = ChaCha8Rng::seed_from_u64(drive.seed);
    let ratio = (BAND.1 / BAND.0).powf(1.0 / SINES as f64);
    let tone = |k: usize| {
        let low = BAND.0 * ratio.powi(k as i32);
        let (high, middle) = (low * ratio, low * ratio.sqrt());
        let variance = drive.class.roughness_m3() * REFERENCE * REFERENCE * (1.0 / low - 1.0 / high);
        let phase_rad = TAU * (source.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        Tone { rate_rad_s: TAU * middle * drive.speed_m_s, amplitude_m: (2.0 * variance).sqrt(), phase_rad }
    };
    (0..SINES).map(tone).collect()
}

/// From the road's height under the front and the rear axle to the pivot's acceleration and the body's pitch rate. States: height
/// and pitch of the body, heights of front and rear axle, and their rates.
fn dynamics(v: Vehicle) -> Result<StateSpace, Error> {
    let a = v.half_base_m;
    // stretch of each suspension: axle less body
    let stretch = [[-1.0, -a, 1.0, 0.0], [-1.0, a, 0.0, 1.0]];
    let push = [
        [1.0 / v.body_mass_kg, a / v.pitch_inertia_kg_m2, -1.0 / v.axle_mass_kg, 0.0],
        [1.0 / v.body_mass_kg, -a / v.pitch_inertia_kg_m2, 0.0, -1.0 / v.axle_mass_kg],
    ];
    let tyre = v.tyre_n_m / v.axle_mass_kg;
    let acceleration = |i: usize, j: usize, coefficient: f64| {
        coefficient * (0..2).map(|s| push[s][i] * stretch[s][j]).sum::<f64>()
    };
    let A = Mat::from_fn(8, 8, |i, j| match (i, j) {
        (0..4, 4..) if j == i + 4 => 1.0,
        (0..4, _) => 0.0,
        (4.., 0..4) => {
            acceleration(i - 4, j, v.suspension_n_m) - if i - 4 == j && j >= 2 { tyre } else { 0.0 }
        }
        _ => acceleration(i - 4, j - 4, v.damping_n_s_m),
    });
    let B = Mat::from_fn(8, 2, |i, j| if i == 6 + j { tyre } else { 0.0 });
    let C = Mat::from_fn(2, 8, |i, j| match i {
        0 => A[(4, j)] + v.pivot_m * A[(5, j)],
        _ => {
            if j == 5 {
                1.0
            } else {
                0.0
            }
        }
    });
    Ok(StateSpace::new(A, B, C, Mat::zeros(2, 2), Timebase::Continuous)?)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::signals::{Sides, rms};
    use counterpoise_lti::{dcgain, poles};

    const G: f64 = 9.80665;
    const DRIVE: RoadDrive = RoadDrive {
        class: RoadClass::C,
        speed_m_s: 8.0,
        duration_s: 60.0,
        sample_period_s: 0.01,
        fade_s: 1.0,
        seed: 3,
    };

    #[test]
    fn the_profile_has_the_variance_of_the_standard() {
        let variance: f64 = profile(DRIVE).iter().map(|tone| 0.5 * tone.amplitude_m * tone.amplitude_m).sum();
        let exact = 256e-6 * 0.01 * (1.0 / BAND.0 - 1.0 / BAND.1);
        assert!((variance / exact - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_vehicle_on_a_slope_takes_the_slope_and_is_damped() {
        let g = dynamics(Vehicle::HEAVY).unwrap();
        let all = poles(&g).unwrap();
        assert!(all.iter().all(|pole| pole.re < 0.0));
        let slowest = all.iter().map(|pole| pole.norm()).fold(f64::INFINITY, f64::min) / TAU;
        assert!((0.8..2.0).contains(&slowest), "{slowest} Hz");
        assert!(dcgain(&g).unwrap().norm_max() < 1e-9, "a steady height moves nothing");
    }

    #[test]
    fn two_classes_worse_is_four_times_the_motion_and_a_seed_repeats() {
        let (c, e) = (
            iso_road(DRIVE, Vehicle::HEAVY, G).unwrap(),
            iso_road(RoadDrive { class: RoadClass::E, ..DRIVE }, Vehicle::HEAVY, G).unwrap(),
        );
        assert!((rms(e.heave_m_s2()) / rms(c.heave_m_s2()) - 4.0).abs() < 1e-9);
        assert_eq!(c, iso_road(DRIVE, Vehicle::HEAVY, G).unwrap());
        assert!((0.2..3.0).contains(&rms(c.heave_m_s2())), "{} m/s^2", rms(c.heave_m_s2()));
        assert!((0.005..0.3).contains(&rms(c.pitch_rate_rad_s())), "{} rad/s", rms(c.pitch_rate_rad_s()));
        assert_eq!(c.heave_m_s2()[0], 0.0);
        assert!(iso_road(RoadDrive { speed_m_s: 0.0, ..DRIVE }, Vehicle::HEAVY, G).is_err());
    }

    #[test]
    fn four_wheels_roll_as_the_two_tracks_differ() {
        let with = |track_m: f64| {
            let sides = Sides { track_m, roll_inertia_kg_m2: 9_000.0, pivot_height_m: 1.0 };
            iso_road(DRIVE, Vehicle { sides: Some(sides), ..Vehicle::HEAVY }, G).unwrap()
        };
        let (narrow, wide) = (with(1e-3), with(2.2));
        let half = iso_road(DRIVE, Vehicle::HEAVY, G).unwrap();
        let roll = |road: &Road| rms(road.roll_rate_rad_s());
        // wheels at one place see one road: the body moves as half a vehicle does
        assert!((rms(narrow.pitch_rate_rad_s()) / rms(half.pitch_rate_rad_s()) - 1.0).abs() < 1e-3);
        assert!((rms(narrow.heave_m_s2()) / rms(half.heave_m_s2()) - 1.0).abs() < 0.02);
        // two independent tracks move it by 1/sqrt(2) of that; real ones lie between
        let share = rms(wide.heave_m_s2()) / rms(half.heave_m_s2());
        assert!((0.68..1.0).contains(&share), "{share}");
        assert!((0.01..0.5).contains(&roll(&wide)), "{} rad/s", roll(&wide));
        let still = Vehicle {
            sides: Some(Sides { track_m: 0.0, roll_inertia_kg_m2: 1.0, pivot_height_m: 0.0 }),
            ..Vehicle::HEAVY
        };
        assert!(iso_road(DRIVE, still, G).is_err());
    }
}
