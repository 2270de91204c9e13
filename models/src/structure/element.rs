//! One element of the beam: mass and stiffness of the deflections and rotations at its two ends.
//!
//! Unknowns [w_1, theta_1, w_2, theta_2], theta = dw/dx (without shear), as in (5-5), (5-6).

use super::power_law::{self, PowerLaw};
use super::profile::{CrossSection, Profile};
use crate::Error;
use nalgebra::{Matrix4, Vector4};

/// Beam theory of an element: with or without shear and rotary inertia.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Theory {
    /// Neither: the thesis' elements.
    #[default]
    BernoulliEuler,
    /// Both: S. Timoshenko, Phil. Mag. 41, 1921.
    Timoshenko,
}

/// Source of an element's cross section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Integration {
    /// The true cross section, by quadrature that is exact for tubes and rectangles of linear dimensions: frequencies are upper bounds.
    #[default]
    Quadrature,
    /// A power law through the near end, middle and far end: (5-17) to (5-20), corrected. Bernoulli-Euler only.
    PowerLaw,
    /// A uniform cross section of the mean diameter: (5-5), (5-6).
    UniformAverage,
}

/// Mass and stiffness of one element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Mass matrix; kg, kg m and kg m^2.
    pub mass: Matrix4<f64>,
    /// Stiffness matrix; N/m, N and N m.
    pub stiffness: Matrix4<f64>,
    /// The functions that interpolate between the nodes.
    pub shape: ElementShape,
}

/// Returns the element from x = `from_m` to `to_m`.
///
/// m_ij = int rho A psi_i psi_j dx (+ rho I theta_i theta_j), k_ij = int E I theta_i' theta_j' dx (+ kappa G A gamma_i
/// gamma_j): (5-2), (5-3) by Gauss' rule with five points on each section that the element spans, which is exact for
/// polynomials of degree 9: all that linear diameters ask for. The shape functions are admissible for any taper, so that
/// the frequencies of an assembly are never below the beam's.
///
/// # Errors
/// [`Error::PowerLaw`] if no power law passes through the element's three cross sections.
pub fn element_matrices(
    profile: &Profile,
    from_m: f64,
    to_m: f64,
    theory: Theory,
    integration: Integration,
) -> Result<Element, Error> {
    match integration {
        Integration::Quadrature => Ok(integrate(profile, from_m, to_m, theory, |x| profile.section_after(x))),
        Integration::UniformAverage => {
            let average = profile.average(from_m, to_m);
            Ok(integrate(profile, from_m, to_m, theory, |_| average))
        }
        Integration::PowerLaw => power_law_element(profile, from_m, to_m),
    }
}

fn integrate(
    profile: &Profile,
    from_m: f64,
    to_m: f64,
    theory: Theory,
    cross_section: impl Fn(f64) -> CrossSection,
) -> Element {
    let shape = ElementShape::new(profile, from_m, to_m, theory);
    let mut out = Element { mass: Matrix4::zeros(), stiffness: Matrix4::zeros(), shape };
    for (a, b) in profile.pieces_m(from_m, to_m) {
        for (point, weight) in GAUSS {
            let x = 0.5 * (a + b) + 0.5 * (b - a) * point;
            out.add(profile, &cross_section(x), x, 0.5 * (b - a) * weight, theory);
        }
    }
    out
}

/// Returns the element from x = `from_m` to `to_m`, Bernoulli-Euler.
///
/// # Errors
/// [`Error::PowerLaw`] if the three cross sections are not monotone, so that no power law passes through them.
fn power_law_element(profile: &Profile, from_m: f64, to_m: f64) -> Result<Element, Error> {
    let (near, far) = (profile.section_after(from_m), profile.section_before(to_m));
    let middle = profile.section_after(0.5 * (from_m + to_m));
    let refused = || Error::PowerLaw { from_m, to_m };
    let area = PowerLaw::fit(near.area_m2, middle.area_m2, far.area_m2).ok_or_else(refused)?;
    let second = PowerLaw::fit(near.second_moment_m4, middle.second_moment_m4, far.second_moment_m4);
    let length = to_m - from_m;
    let line_mass = profile.density_kg_m3() * near.area_m2;
    let rigidity = profile.youngs_modulus_pa() * near.second_moment_m4;
    Ok(Element {
        mass: power_law::element_mass(line_mass, length, &area),
        stiffness: power_law::element_stiffness(rigidity, length, &second.ok_or_else(refused)?),
        shape: ElementShape::hermite(from_m, to_m),
    })
}

impl Element {
    fn add(&mut self, profile: &Profile, at: &CrossSection, x_m: f64, weight: f64, theory: Theory) {
        let local = self.shape.at(x_m);
        let line = weight * profile.density_kg_m3();
        add_outer(&mut self.mass, line * at.area_m2, &local.deflection);
        add_outer(
            &mut self.stiffness,
            weight * profile.youngs_modulus_pa() * at.second_moment_m4,
            &local.curvature,
        );
        if theory == Theory::Timoshenko {
            add_outer(&mut self.mass, line * at.second_moment_m4, &local.rotation);
            let rigidity = at.shear_coefficient * profile.shear_modulus_pa() * at.area_m2;
            add_outer(&mut self.stiffness, weight * rigidity, &local.shear);
        }
    }
}

/// The interpolation of an element: cubic, with linear terms if shear counts (Friedman and Kosmatka, Computers and
/// Structures 47, 1993), phi = 12 E I / (kappa G A L^2) of the mean cross section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementShape {
    from_m: f64,
    length_m: f64,
    shear_share: f64,
}

/// The four shape functions at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapeValues {
    /// Deflection w.
    pub deflection: Vector4<f64>,
    /// Rotation theta, 1/m for the deflections' functions.
    pub rotation: Vector4<f64>,
    /// Curvature theta', 1/m^2 and 1/m.
    pub curvature: Vector4<f64>,
    /// Shear strain w' - theta.
    pub shear: Vector4<f64>,
}

impl ElementShape {
    fn new(profile: &Profile, from_m: f64, to_m: f64, theory: Theory) -> Self {
        let length_m = to_m - from_m;
        let mean = profile.average(from_m, to_m);
        let bending = profile.youngs_modulus_pa() * mean.second_moment_m4;
        let rigidity = mean.shear_coefficient * profile.shear_modulus_pa() * mean.area_m2;
        let shear_share = match theory {
            Theory::BernoulliEuler => 0.0,
            Theory::Timoshenko => 12.0 * bending / (rigidity * length_m * length_m),
        };
        Self { from_m, length_m, shear_share }
    }

    /// Returns Hermite's cubics.
    pub fn hermite(from_m: f64, to_m: f64) -> Self {
        Self { from_m, length_m: to_m - from_m, shear_share: 0.0 }
    }

    /// Returns the shape functions at x.
    pub fn at(&self, x_m: f64) -> ShapeValues {
        let (l, p) = (self.length_m, self.shear_share);
        let x = (x_m - self.from_m) / l;
        let scale = 1.0 / (1.0 + p);
        let third = x * x * (3.0 - 2.0 * x) + p * x;
        let slope = 6.0 * (x - x * x) * scale / l;
        let bend = (6.0 - 12.0 * x) * scale / (l * l);
        let lean = 0.5 * p * (x - x * x);
        ShapeValues {
            deflection: Vector4::new(
                1.0 - third * scale,
                l * (x * (1.0 - x) * (1.0 - x) + lean) * scale,
                third * scale,
                l * (x * x * (x - 1.0) - lean) * scale,
            ),
            rotation: Vector4::new(
                -slope,
                (1.0 + x * (3.0 * x - 4.0) + p * (1.0 - x)) * scale,
                slope,
                (x * (3.0 * x - 2.0) + p * x) * scale,
            ),
            curvature: Vector4::new(
                -bend,
                (6.0 * x - 4.0 - p) * scale / l,
                bend,
                (6.0 * x - 2.0 + p) * scale / l,
            ),
            shear: Vector4::new(-p * scale / l, -0.5 * p * scale, p * scale / l, -0.5 * p * scale),
        }
    }
}

/// Adds factor (a a') to a matrix.
fn add_outer(matrix: &mut Matrix4<f64>, factor: f64, a: &Vector4<f64>) {
    *matrix += a * a.transpose() * factor;
}

/// Points and weights of Gauss' rule on [-1, 1].
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];
