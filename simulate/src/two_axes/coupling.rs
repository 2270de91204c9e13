//! The effect of each axis on the other over a sample: the ring's motion as motion of the base of the elevation axis, and the torque of the elevated body
//! on the traverse axis.

use super::base::{BasePoint, BaseSample};
use super::quartics::{AT, PLACES, Quartics, Trace};
use crate::engine::ports::NearbyAngle;
use crate::motion::MotionSample;
use counterpoise_models::Plant;
use counterpoise_models::plant::SinCos;
use counterpoise_models::two_axes::{ElevatedBody, ElevationMotion, RingMotion};

/// Index of the torque of another axis among what a base does beside heave and pitch.
const OTHER: usize = 3;

/// Torque of the elevated body on the traverse axis at the places of a sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct TraverseTorque {
    pub torque_nm: [f64; PLACES],
    /// Inertia that the body adds to the parameters of the traverse axis, kg m^2.
    pub added_kg_m2: [f64; PLACES],
}

/// The coupling of the two axes, with the angles whose sines are known.
#[derive(Debug, Clone)]
pub(super) struct Coupler {
    pub quartics: Quartics,
    body: ElevatedBody,
    period_s: f64,
    gravity_m_s2: f64,
    /// Inertia about the normal less that about the beam, as the elevation plant has it, kg m^2.
    slender_kg_m2: f64,
    is_slender: bool,
    traverse: NearbyAngle,
    yaw: NearbyAngle,
    pitch: NearbyAngle,
    elevation: NearbyAngle,
    /// Torque on the elevation axis per change of what it feels of the base.
    sensitivity: Sensitivity,
}

/// Torque on the elevation axis per change of what it feels of the base.
#[derive(Debug, Clone, Copy)]
struct Sensitivity {
    /// First moment, kg m.
    moment_kg_m: f64,
    /// Drag and stiffness of transmission and friction over a sample, N m s/rad.
    drag_nm_s: f64,
}

impl Coupler {
    pub fn new(body: ElevatedBody, elevation: &Plant, period_s: f64) -> Self {
        let parameters = elevation.parameters();
        let slender = elevation.body().inertia_kg_m2 - parameters.reflected_inertia_kg_m2();
        let gearbox = &parameters.gearbox;
        let stiffness = if gearbox.is_rigid() { 0.0 } else { gearbox.stiffness_nm_rad };
        let damping = if gearbox.is_rigid() { 0.0 } else { gearbox.damping_nm_s_rad };
        let zero = NearbyAngle::new(0.0);
        Self {
            quartics: Quartics::new(),
            is_slender: body.inertia.is_slender(slender),
            slender_kg_m2: slender,
            gravity_m_s2: parameters.gravity_m_s2,
            period_s,
            traverse: zero,
            yaw: zero,
            pitch: zero,
            elevation: zero,
            sensitivity: Sensitivity {
                moment_kg_m: body.out_of_balance_kg_m.hypot(body.vertical_offset_kg_m),
                drag_nm_s: damping + stiffness * period_s + parameters.pivot_friction.viscous_nm_s_rad,
            },
            body,
        }
    }

    /// Returns what the traverse axis feels of the base: its yaw, and the lateral and forward specific force in axes that do not yaw. The
    /// torque of the other axis is left at 0.
    pub fn traverse_motion(&mut self, base: &BaseSample, angle_rad: f64) -> MotionSample {
        let mut motion = MotionSample {
            angle_rad,
            period_s: self.period_s,
            rate: base.yaw,
            heave: [0.0; 5],
            further: None,
        };
        let (mut lateral, mut forward) = ([0.0; PLACES], [0.0; PLACES]);
        for (k, place) in base.places.iter().enumerate() {
            let SinCos { sin, cos } = self.yaw.follow(motion.at(AT[k]).angle);
            let [x, y, _] = place.force;
            (lateral[k], forward[k]) = (x * sin + y * cos, x * cos - y * sin);
        }
        motion.heave = self.quartics.interpolate(&lateral);
        motion.further = Some([self.quartics.interpolate(&forward), [0.0; 5], [0.0; 5], [0.0; 5]]);
        motion
    }

    /// Returns the ring's motion at the places, from what the traverse axis did on its own base.
    pub fn ring_motion(
        &mut self,
        base: &BaseSample,
        motion: &MotionSample,
        traverse: &Trace,
    ) -> [RingMotion; PLACES] {
        let turns = self.quartics.slopes(&traverse.rate_rad_s);
        let mut ring = [RingMotion::default(); PLACES];
        for k in 0..PLACES {
            let angle = traverse.angle_rad[k] - motion.at(AT[k]).angle;
            let up = RingRate { rate_rad_s: traverse.rate_rad_s[k], turn_rad_s2: turns[k] / self.period_s };
            ring[k] = ring_at(&base.places[k], self.traverse.follow(angle), up);
        }
        ring
    }

    /// Returns what the elevation axis feels of a ring's motion, from an angle of its platform on; `elevation_rad` is its angle relative to
    /// the ring, as far as it is known.
    pub fn elevation_motion(
        &mut self,
        ring: &[RingMotion; PLACES],
        angle_rad: f64,
        elevation_rad: &[f64; PLACES],
    ) -> MotionSample {
        let pitch = ring.each_ref().map(|at| -at.rate_rad_s[1]);
        let mut motion = MotionSample {
            angle_rad,
            period_s: self.period_s,
            rate: self.quartics.interpolate(&pitch),
            heave: [0.0; 5],
            further: None,
        };
        let mut felt = [[0.0; PLACES]; 5];
        for (k, at) in ring.iter().enumerate() {
            let SinCos { sin, cos } = self.pitch.follow(motion.at(AT[k]).angle);
            let [forward, _, up] = self.body.specific_force_at_pivot(at);
            let [roll, _, yaw] = at.rate_rad_s;
            felt[0][k] = forward * sin + up * cos - self.gravity_m_s2;
            felt[1][k] = forward * cos - up * sin;
            felt[2][k] = roll * cos - yaw * sin;
            felt[3][k] = roll * sin + yaw * cos;
            if !self.is_slender {
                let tilt = self.elevation.follow(elevation_rad[k]);
                let rates = ElevatedBody::off_axis_rates(at, tilt);
                felt[4][k] = self.body.inertia.torque_beside_slender_nm(self.slender_kg_m2, rates);
            }
        }
        let [heave, surge, roll, yaw, torque] =
            felt.each_ref().map(|values| self.quartics.interpolate(values));
        motion.heave = heave;
        motion.further = Some([surge, roll, yaw, torque]);
        motion
    }

    /// Returns a bound on the torque that tells two motions of the elevation axis' base apart, N m.
    pub fn difference_nm(&self, a: &MotionSample, b: &MotionSample) -> f64 {
        let apart = |a: &[f64; 5], b: &[f64; 5]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>();
        let (Some(of_a), Some(of_b)) = (&a.further, &b.further) else { return f64::INFINITY };
        let fastest = of_a[1][0].abs() + of_a[2][0].abs();
        self.sensitivity.moment_kg_m * (apart(&a.heave, &b.heave) + apart(&of_a[0], &of_b[0]))
            + self.sensitivity.drag_nm_s * apart(&a.rate, &b.rate)
            + 2.0 * self.slender_kg_m2 * fastest * (apart(&of_a[1], &of_b[1]) + apart(&of_a[2], &of_b[2]))
            + apart(&of_a[OTHER], &of_b[OTHER])
    }

    /// Returns whether the body turns as the elevation plant takes it, without a torque beside that plant's.
    pub fn is_slender(&self) -> bool {
        self.is_slender
    }

    /// Returns the rates about the normal of the beam at the places, rad/s.
    pub fn cross_rates(
        &mut self,
        ring: &[RingMotion; PLACES],
        elevation_rad: &[f64; PLACES],
    ) -> [f64; PLACES] {
        std::array::from_fn(|k| {
            let [_, normal] = ElevatedBody::off_axis_rates(&ring[k], self.elevation.follow(elevation_rad[k]));
            normal
        })
    }

    /// Returns the elevation relative to the ring at the places.
    pub fn elevation_rad(&self, motion: &MotionSample, elevation: &Trace) -> [f64; PLACES] {
        std::array::from_fn(|k| elevation.angle_rad[k] - motion.at(AT[k]).angle)
    }

    /// Returns the torque of the elevated body on the traverse axis.
    pub fn torque(
        &mut self,
        ring: &[RingMotion; PLACES],
        elevation_rad: &[f64; PLACES],
        elevation: &Trace,
    ) -> TraverseTorque {
        let turns = self.quartics.slopes(&elevation.rate_rad_s);
        let mut found = TraverseTorque { torque_nm: [0.0; PLACES], added_kg_m2: [0.0; PLACES] };
        for k in 0..PLACES {
            let at = ElevationMotion {
                tilt: self.elevation.follow(elevation_rad[k]),
                rate_rad_s: elevation.rate_rad_s[k],
                acceleration_rad_s2: turns[k] / self.period_s,
            };
            found.torque_nm[k] = self.body.torque_on_traverse_nm(&ring[k], &at);
            found.added_kg_m2[k] = self.body.added_inertia_kg_m2(at.tilt);
        }
        found
    }
}

/// The ring's motion about its own axis.
#[derive(Debug, Clone, Copy)]
struct RingRate {
    rate_rad_s: f64,
    turn_rad_s2: f64,
}

/// Returns the motion of a ring that is turned by an angle on its base.
#[inline]
fn ring_at(base: &BasePoint, SinCos { sin, cos }: SinCos, up: RingRate) -> RingMotion {
    let turned = |[x, y, _]: [f64; 3]| [x * cos + y * sin, y * cos - x * sin];
    let ([forward, left], [roll, pitch]) = (turned(base.force), turned(base.rate));
    let [roll_turn, pitch_turn] = turned(base.turn);
    let relative = up.rate_rad_s - base.rate[2];
    RingMotion {
        specific_force_m_s2: [forward, left, base.force[2]],
        rate_rad_s: [roll, pitch, up.rate_rad_s],
        acceleration_rad_s2: [roll_turn + relative * pitch, pitch_turn - relative * roll, up.turn_rad_s2],
    }
}
