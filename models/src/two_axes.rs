//! The elevated body on a traverse ring: what couples the two axes.
//!
//! Axes of the ring: x forward, y to the left, z up; it turns with the inertial rates P, -Q and R about them, Q about the elevation axis and R
//! with its own rate relative to the base. The elevated body has a plane of symmetry through its beam b and the normal n of the beam,
//! turns with w_h about the elevation axis, and stands at theta relative to the ring. Its pivot lies at p on the ring, and its mass there
//! counts as the ring's. What is left of it is its first moment m and its inertia I about the pivot:
//!
//! ```text
//!     T = v_p . (w x m) + w . I w / 2                    v_p: velocity of the pivot, w: rate of the body
//! ```
//!
//! Lagrange's equations of both axes follow from it. The elevation axis feels the specific force at its pivot and the rates P and R, which
//! [`crate::base_motion`] describes. The traverse axis feels
//!
//! ```text
//!     T_z = -(p x d^2m/dt^2 + dH/dt + m x s_p)_z         H = I w, s_p: specific force at the pivot
//! ```
//!
//! with all derivatives inertial. The traverse axis' own parameters hold the body at one elevation; the torque here is the difference.
//! `docs/theory/base-motion.md` has the equations, and `tests/peers/base_motion/two_axes.py` derives them symbolically.

use crate::Plant;
use crate::plant::SinCos;
use crate::tolerance::SAME_INERTIA;
use nalgebra::Vector3;

/// The elevated body as the traverse ring feels it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElevatedBody {
    /// First moment of mass along the beam, kg m, positive nose-heavy.
    pub out_of_balance_kg_m: f64,
    /// First moment of mass along the normal of the beam, kg m.
    pub vertical_offset_kg_m: f64,
    /// Inertia at the pivot.
    pub inertia: BodyInertia,
    /// Position of the pivot, from the ring's axis.
    pub pivot: PivotPosition,
    /// Elevation at which the parameters of the traverse axis include the body.
    pub included_at: SinCos,
}

/// Inertias and offsets that couple the two axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling {
    /// The elevated body as the traverse ring feels it.
    pub body: ElevatedBody,
    /// Place of the gyroscope of the traverse axis.
    pub gyroscope: TraverseGyroscope,
}

/// Place of the gyroscope of the traverse axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TraverseGyroscope {
    /// On the ring: it reads the ring's rate R about its own axis.
    Ring,
    /// On the elevated mass, along the normal of the beam: it reads R cos(theta) - P sin(theta), the rate in cross-elevation.
    ElevatedMass,
}

/// Moments of inertia of a body with a plane of symmetry, at its pivot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyInertia {
    /// About the elevation axis, kg m^2.
    pub about_axis_kg_m2: f64,
    /// About the beam, kg m^2.
    pub about_beam_kg_m2: f64,
    /// About the normal of the beam, kg m^2.
    pub about_normal_kg_m2: f64,
    /// Product of inertia: the integral of beam times normal coordinate over the mass, kg m^2.
    pub product_kg_m2: f64,
}

impl BodyInertia {
    /// Returns whether a body can have it: a plane one in which the square of the product is at most beam times normal, and the moment about the axis, across
    /// the plane, at most their sum. A body that is not slender is as thick as the sum exceeds the moment.
    pub fn is_physical(&self) -> bool {
        let (beam, normal) = (self.about_beam_kg_m2, self.about_normal_kg_m2);
        let rounding = 1.0 + SAME_INERTIA;
        self.product_kg_m2.powi(2) <= beam * normal * rounding
            && self.about_axis_kg_m2 <= (beam + normal) * rounding
    }
}

/// The elevation pivot on the traverse ring.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PivotPosition {
    /// In front of the ring's axis, m.
    pub forward_m: f64,
    /// To the left of the ring's axis, m.
    pub left_m: f64,
}

/// The ring at one instant, in its own axes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RingMotion {
    /// Specific force on the ring's axis at the height of the elevation pivot, m/s^2.
    pub specific_force_m_s2: [f64; 3],
    /// Inertial rates P, -Q and R, rad/s.
    pub rate_rad_s: [f64; 3],
    /// Their derivatives, rad/s^2.
    pub acceleration_rad_s2: [f64; 3],
}

/// The elevated body at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElevationMotion {
    /// Angle relative to the ring.
    pub tilt: SinCos,
    /// Inertial rate about the elevation axis, rad/s.
    pub rate_rad_s: f64,
    /// Derivative, rad/s^2.
    pub acceleration_rad_s2: f64,
}

/// A vector in axes of the elevated body: beam, normal, elevation axis (right-handed).
#[derive(Debug, Clone, Copy)]
struct BodyVector {
    beam: f64,
    normal: f64,
    axis: f64,
}

impl BodyInertia {
    /// Returns the inertia of a slender beam: none about itself, the same about its normal as about the elevation axis.
    pub fn slender(inertia_kg_m2: f64) -> Self {
        Self {
            about_axis_kg_m2: inertia_kg_m2,
            about_beam_kg_m2: 0.0,
            about_normal_kg_m2: inertia_kg_m2,
            product_kg_m2: 0.0,
        }
    }

    /// Returns the inertia of the body of an elevation plant as a slender beam, as that plant takes it.
    pub fn of_plant(elevation: &Plant) -> Self {
        let rotor = elevation.parameters().reflected_inertia_kg_m2();
        Self::slender(elevation.body().inertia_kg_m2 - rotor)
    }

    #[inline]
    fn times(&self, rate: BodyVector) -> BodyVector {
        BodyVector {
            beam: self.about_beam_kg_m2 * rate.beam - self.product_kg_m2 * rate.normal,
            normal: self.about_normal_kg_m2 * rate.normal - self.product_kg_m2 * rate.beam,
            axis: self.about_axis_kg_m2 * rate.axis,
        }
    }

    /// Returns the torque about the elevation axis of rates about beam and normal, less that of a slender beam, N m:
    /// `-(J_n - J_b - J') w_b w_n + D (w_b^2 - w_n^2)`.
    pub fn torque_beside_slender_nm(&self, slender_kg_m2: f64, [beam, normal]: [f64; 2]) -> f64 {
        let difference = self.about_normal_kg_m2 - self.about_beam_kg_m2 - slender_kg_m2;
        self.product_kg_m2 * (beam * beam - normal * normal) - difference * beam * normal
    }

    /// Returns whether the body turns as a slender beam does.
    pub fn is_slender(&self, slender_kg_m2: f64) -> bool {
        self.about_normal_kg_m2 - self.about_beam_kg_m2 == slender_kg_m2 && self.product_kg_m2 == 0.0
    }
}

impl ElevatedBody {
    /// Returns the body of an elevation plant with an inertia of its own about the other axes.
    pub fn of_plant(
        elevation: &Plant,
        inertia: BodyInertia,
        pivot: PivotPosition,
        included_at: SinCos,
    ) -> Self {
        let body = elevation.body();
        Self {
            out_of_balance_kg_m: body.out_of_balance_kg_m,
            vertical_offset_kg_m: body.vertical_offset_kg_m,
            inertia,
            pivot,
            included_at,
        }
    }

    /// Returns the first moment along the ring's forward and upward axes at an elevation, kg m.
    #[inline]
    fn first_moment(&self, SinCos { sin, cos }: SinCos) -> Vector3<f64> {
        let (mu, nu) = (self.out_of_balance_kg_m, self.vertical_offset_kg_m);
        Vector3::new(mu * cos - nu * sin, 0.0, mu * sin + nu * cos)
    }

    /// Returns the moment of inertia about the ring's axis at an elevation, without that of the mass at the pivot, kg m^2.
    #[inline]
    pub fn inertia_about_ring_kg_m2(&self, tilt: SinCos) -> f64 {
        let SinCos { sin, cos } = tilt;
        let inertia = &self.inertia;
        inertia.about_beam_kg_m2 * sin * sin + inertia.about_normal_kg_m2 * cos * cos
            - 2.0 * inertia.product_kg_m2 * sin * cos
            + 2.0 * self.pivot.forward_m * self.first_moment(tilt).x
    }

    /// Returns how much larger the moment of inertia about the ring's axis is than the parameters of the traverse axis say, kg m^2.
    #[inline]
    pub fn added_inertia_kg_m2(&self, tilt: SinCos) -> f64 {
        self.inertia_about_ring_kg_m2(tilt) - self.inertia_about_ring_kg_m2(self.included_at)
    }

    /// Returns the specific force at the elevation pivot in axes of the ring, m/s^2.
    #[inline]
    pub fn specific_force_at_pivot(&self, ring: &RingMotion) -> [f64; 3] {
        if self.pivot == PivotPosition::default() {
            return ring.specific_force_m_s2;
        }
        let (rate, turn) = (Vector3::from(ring.rate_rad_s), Vector3::from(ring.acceleration_rad_s2));
        let at = Vector3::new(self.pivot.forward_m, self.pivot.left_m, 0.0);
        (Vector3::from(ring.specific_force_m_s2) + turn.cross(&at) + rate.cross(&rate.cross(&at))).into()
    }

    /// Returns the rates about the beam and about its normal, rad/s.
    #[inline]
    pub fn off_axis_rates(ring: &RingMotion, SinCos { sin, cos }: SinCos) -> [f64; 2] {
        let [forward, _, up] = ring.rate_rad_s;
        [forward * cos + up * sin, up * cos - forward * sin]
    }

    /// Returns the torque of the elevated body on the traverse axis beside what the parameters of that axis hold of it, N m.
    #[inline]
    pub fn torque_on_traverse_nm(&self, ring: &RingMotion, elevation: &ElevationMotion) -> f64 {
        let moment = self.first_moment(elevation.tilt);
        let mut needed = self.spin(ring, elevation) + moment.x * ring.specific_force_m_s2[1];
        if self.pivot != PivotPosition::default() {
            needed += self.torque_off_axis(&moment, ring, elevation);
        }
        let included = self.inertia_about_ring_kg_m2(self.included_at) * ring.acceleration_rad_s2[2]
            + self.first_moment(self.included_at).x * ring.specific_force_m_s2[1];
        included - needed
    }

    /// Returns what a pivot off the ring's axis adds to the torque that a motion needs, N m.
    fn torque_off_axis(&self, moment: &Vector3<f64>, ring: &RingMotion, elevation: &ElevationMotion) -> f64 {
        let lateral = self.specific_force_at_pivot(ring)[1] - ring.specific_force_m_s2[1];
        let pull = second_derivative(moment, ring, elevation);
        moment.x * lateral + self.pivot.forward_m * pull.y - self.pivot.left_m * pull.x
    }

    /// Returns the derivative of the angular momentum about the pivot along the ring's axis, N m: Euler's equations in axes of the body.
    #[inline]
    fn spin(&self, ring: &RingMotion, elevation: &ElevationMotion) -> f64 {
        let SinCos { sin, cos } = elevation.tilt;
        let [beam, normal] = Self::off_axis_rates(ring, elevation.tilt);
        let [forward, _, up] = ring.acceleration_rad_s2;
        let relative = elevation.rate_rad_s + ring.rate_rad_s[1];
        let rate = BodyVector { beam, normal, axis: elevation.rate_rad_s };
        let turn = BodyVector {
            beam: forward * cos + up * sin + relative * normal,
            normal: up * cos - forward * sin - relative * beam,
            axis: elevation.acceleration_rad_s2,
        };
        let (momentum, change) = (self.inertia.times(rate), self.inertia.times(turn));
        let about_beam = change.beam + rate.normal * momentum.axis - rate.axis * momentum.normal;
        let about_normal = change.normal + rate.axis * momentum.beam - rate.beam * momentum.axis;
        sin * about_beam + cos * about_normal
    }

    /// Returns the kinetic energy of the body on a base at rest beside that of its mass at the pivot, J.
    pub fn kinetic_energy_j(&self, ring_rate_rad_s: f64, elevation: &ElevationMotion) -> f64 {
        let ring = RingMotion { rate_rad_s: [0.0, 0.0, ring_rate_rad_s], ..RingMotion::default() };
        let [beam, normal] = Self::off_axis_rates(&ring, elevation.tilt);
        let rate = BodyVector { beam, normal, axis: elevation.rate_rad_s };
        let momentum = self.inertia.times(rate);
        let spin = 0.5 * (beam * momentum.beam + normal * momentum.normal + rate.axis * momentum.axis);
        let turn = Vector3::new(0.0, -elevation.rate_rad_s, ring_rate_rad_s);
        let pivot = Vector3::new(-self.pivot.left_m, self.pivot.forward_m, 0.0) * ring_rate_rad_s;
        spin + pivot.dot(&turn.cross(&self.first_moment(elevation.tilt)))
    }

    /// Returns the angular momentum of the body about the axis of a ring on a base at rest, beside that of its mass at the pivot, N m s.
    pub fn angular_momentum_nm_s(&self, ring_rate_rad_s: f64, elevation: &ElevationMotion) -> f64 {
        let moment = self.first_moment(elevation.tilt);
        self.inertia_about_ring_kg_m2(elevation.tilt) * ring_rate_rad_s
            + self.pivot.left_m * moment.z * elevation.rate_rad_s
    }
}

/// Returns the inertial second derivative of a vector of the elevated body, in axes of the ring.
fn second_derivative(of: &Vector3<f64>, ring: &RingMotion, elevation: &ElevationMotion) -> Vector3<f64> {
    let ([forward, left, up], turned) = (ring.rate_rad_s, ring.acceleration_rad_s2);
    let relative = elevation.rate_rad_s + left;
    let rate = Vector3::new(forward, -elevation.rate_rad_s, up);
    let turn = Vector3::new(
        turned[0] + relative * up,
        -elevation.acceleration_rad_s2,
        turned[2] - relative * forward,
    );
    turn.cross(of) + rate.cross(&rate.cross(of))
}
