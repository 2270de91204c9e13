//! The cross section along the beam.

use crate::Error;
use crate::parameters::{Beam, BeamSection, SectionShape};
use crate::tolerance::ADJOINING;
use std::f64::consts::PI;

/// A beam whose sections have been checked: they adjoin, have a positive extent and a positive cross section.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    youngs_modulus_pa: f64,
    shear_modulus_pa: f64,
    poissons_ratio: f64,
    density_kg_m3: f64,
    sections: Vec<BeamSection>,
}

/// Properties of the cross section at a place, as an element needs them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossSection {
    /// Area A, m^2.
    pub area_m2: f64,
    /// Second moment of area I, m^4.
    pub second_moment_m4: f64,
    /// Shear coefficient kappa: shear stiffness is kappa G A.
    pub shear_coefficient: f64,
}

/// Shear coefficient if only area and second moment are given: that of a rectangle without Poisson's effect.
const SHEAR_COEFFICIENT: f64 = 5.0 / 6.0;

impl Profile {
    /// Returns the profile of a beam.
    ///
    /// # Errors
    /// [`Error::Parameter`] names what is out of range: modulus, density, a section's extent, gap or cross section,
    /// the pivot outside the beam.
    pub fn new(beam: &Beam) -> Result<Self, Error> {
        check(
            "beam.youngs_modulus",
            beam.youngs_modulus_pa,
            NumberRequirement { holds: beam.youngs_modulus_pa > 0.0, words: "must be positive" },
        )?;
        check(
            "beam.density",
            beam.density_kg_m3,
            NumberRequirement { holds: beam.density_kg_m3 > 0.0, words: "must be positive" },
        )?;
        let ratio = beam.poissons_ratio;
        check(
            "beam.poissons_ratio",
            ratio,
            NumberRequirement {
                holds: ratio > -1.0 && ratio <= 0.5,
                words: "must be above -1 and at most 0.5",
            },
        )?;
        let out = Self {
            youngs_modulus_pa: beam.youngs_modulus_pa,
            shear_modulus_pa: beam.youngs_modulus_pa / (2.0 * (1.0 + ratio)),
            poissons_ratio: ratio,
            density_kg_m3: beam.density_kg_m3,
            sections: beam.sections.clone(),
        };
        out.check_sections()?;
        let inside = out.start_m() <= beam.pivot_m && beam.pivot_m <= out.end_m();
        check(
            "beam.pivot",
            beam.pivot_m,
            NumberRequirement { holds: inside, words: "must lie on the beam" },
        )?;
        Ok(out)
    }

    /// Returns the near end of the beam, m.
    pub fn start_m(&self) -> f64 {
        self.sections.first().map_or(0.0, |s| s.from_m)
    }

    /// Returns the far end of the beam, m.
    pub fn end_m(&self) -> f64 {
        self.sections.last().map_or(0.0, |s| s.to_m)
    }

    /// Returns Young's modulus E, Pa.
    pub fn youngs_modulus_pa(&self) -> f64 {
        self.youngs_modulus_pa
    }

    /// Returns the shear modulus G = E / (2 (1 + nu)), Pa.
    pub fn shear_modulus_pa(&self) -> f64 {
        self.shear_modulus_pa
    }

    /// Returns the density, kg/m^3.
    pub fn density_kg_m3(&self) -> f64 {
        self.density_kg_m3
    }

    /// Returns the ends of the sections, m, both ends of the beam included.
    pub fn stations_m(&self) -> Vec<f64> {
        let starts = self.sections.iter().map(|s| s.from_m);
        starts.chain([self.end_m()]).collect()
    }

    /// Returns the pieces of [from, to] that lie in one section each.
    pub fn pieces_m(&self, from_m: f64, to_m: f64) -> Vec<(f64, f64)> {
        let cut = |s: &BeamSection| (s.from_m.max(from_m), s.to_m.min(to_m));
        let long = |(a, b): &(f64, f64)| b - a > ADJOINING * (to_m - from_m);
        self.sections.iter().map(cut).filter(long).collect()
    }

    /// Returns the cross section at x, of the section that begins there where two meet.
    pub fn section_after(&self, x_m: f64) -> CrossSection {
        let at = self.sections.iter().rposition(|s| s.from_m <= x_m).unwrap_or(0);
        self.cross_section(at, x_m)
    }

    /// Returns the cross section at x, of the section that ends there where two meet.
    pub fn section_before(&self, x_m: f64) -> CrossSection {
        let at = self.sections.iter().position(|s| x_m <= s.to_m).unwrap_or(self.sections.len() - 1);
        self.cross_section(at, x_m)
    }

    /// Returns the uniform cross section that the thesis gives an element: of the mean diameters (given areas and second
    /// moments are averaged themselves).
    pub fn average(&self, from_m: f64, to_m: f64) -> CrossSection {
        let length = to_m - from_m;
        let mut mean = [0.0; 6];
        for (a, b) in self.pieces_m(from_m, to_m) {
            let weight = (b - a) / length;
            let middle = 0.5 * (a + b);
            let at = self.sections.iter().rposition(|s| s.from_m <= middle).unwrap_or(0);
            let values = dimensions(&self.sections[at], middle);
            mean.iter_mut().zip(values).for_each(|(m, v)| *m += weight * v);
        }
        self.made_of(mean)
    }

    fn cross_section(&self, section: usize, x_m: f64) -> CrossSection {
        self.made_of(dimensions(&self.sections[section], x_m))
    }

    /// Cross section of a tube [D, d, 0, 0, 0, 0], of given values [0, 0, A, I, 0, 0] or of a rectangle [0, 0, 0, 0, h, w].
    fn made_of(&self, [outer, inner, area, second, height, width]: [f64; 6]) -> CrossSection {
        CrossSection {
            area_m2: area + PI / 4.0 * (outer * outer - inner * inner) + height * width,
            second_moment_m4: second
                + PI / 64.0 * (outer.powi(4) - inner.powi(4))
                + width * height.powi(3) / 12.0,
            shear_coefficient: match (outer > 0.0, height > 0.0) {
                (true, _) => cowper(inner / outer, self.poissons_ratio),
                (_, true) => rectangle(self.poissons_ratio),
                _ => SHEAR_COEFFICIENT,
            },
        }
    }

    fn check_sections(&self) -> Result<(), Error> {
        check(
            "beam.section",
            0.0,
            NumberRequirement { holds: !self.sections.is_empty(), words: "at least one is needed" },
        )?;
        let length = self.end_m() - self.start_m();
        for (i, section) in self.sections.iter().enumerate() {
            let path = |field: &str| format!("beam.section[{i}].{field}");
            check(
                &path("to"),
                section.to_m,
                NumberRequirement {
                    holds: section.to_m > section.from_m,
                    words: "must lie beyond the section's start",
                },
            )?;
            let gap = if i > 0 { section.from_m - self.sections[i - 1].to_m } else { 0.0 };
            check(
                &path("from"),
                section.from_m,
                NumberRequirement {
                    holds: gap.abs() <= ADJOINING * length,
                    words: "must adjoin the section before",
                },
            )?;
            [section.from_m, section.to_m].into_iter().try_for_each(|x| self.check_end(i, x, &path))?;
        }
        Ok(())
    }

    fn check_end(&self, i: usize, x_m: f64, path: &impl Fn(&str) -> String) -> Result<(), Error> {
        let [outer, inner, _, _, height, width] = dimensions(&self.sections[i], x_m);
        check(
            &path("inner_diameter"),
            inner,
            NumberRequirement { holds: inner >= 0.0, words: "must not be negative" },
        )?;
        check(
            &path("height"),
            height,
            NumberRequirement { holds: height >= 0.0, words: "must not be negative" },
        )?;
        check(
            &path("width"),
            width,
            NumberRequirement { holds: width >= 0.0, words: "must not be negative" },
        )?;
        let at = self.cross_section(i, x_m);
        let solid = outer >= 0.0 && at.area_m2 > 0.0 && at.second_moment_m4 > 0.0;
        let field = match self.sections[i].shape {
            SectionShape::Tube { .. } => "outer_diameter",
            SectionShape::Rectangle { .. } => "height",
            SectionShape::Given { .. } => "area",
        };
        check(
            &path(field),
            at.area_m2,
            NumberRequirement { holds: solid || self.is_point(i, x_m), words: "leaves no cross section" },
        )
    }

    /// Returns whether x is an end of the beam that may taper to a point.
    fn is_point(&self, section: usize, x_m: f64) -> bool {
        let at = self.cross_section(section, x_m);
        let ends = x_m == self.start_m() || x_m == self.end_m();
        ends && at.area_m2 == 0.0 && at.second_moment_m4 == 0.0
    }
}

/// Outer and inner diameter, given area and second moment, height and width; 0 if the section has none.
fn dimensions(section: &BeamSection, x_m: f64) -> [f64; 6] {
    let t = (x_m - section.from_m) / (section.to_m - section.from_m);
    let linear = |[near, far]: [f64; 2]| near + (far - near) * t;
    match section.shape {
        SectionShape::Tube { outer_diameter_m, inner_diameter_m } => {
            [linear(outer_diameter_m), linear(inner_diameter_m), 0.0, 0.0, 0.0, 0.0]
        }
        SectionShape::Given { area_m2, second_moment_m4 } => {
            [0.0, 0.0, linear(area_m2), linear(second_moment_m4), 0.0, 0.0]
        }
        SectionShape::Rectangle { height_m, width_m } => {
            [0.0, 0.0, 0.0, 0.0, linear(height_m), linear(width_m)]
        }
    }
}

/// Shear coefficient of a rectangle: Cowper, as for the tube.
fn rectangle(poissons_ratio: f64) -> f64 {
    10.0 * (1.0 + poissons_ratio) / (12.0 + 11.0 * poissons_ratio)
}

/// Shear coefficient of a tube, m = inner / outer diameter: G. Cowper, "The shear coefficient in Timoshenko's beam
/// theory", ASME J. Applied Mechanics 33, 1966.
fn cowper(m: f64, poissons_ratio: f64) -> f64 {
    let (nu, round) = (poissons_ratio, (1.0 + m * m).powi(2));
    6.0 * (1.0 + nu) * round / ((7.0 + 6.0 * nu) * round + (20.0 + 12.0 * nu) * m * m)
}

/// A requirement on a number: whether it holds, and in words.
struct NumberRequirement {
    holds: bool,
    words: &'static str,
}

fn check(parameter: &str, value: f64, required: NumberRequirement) -> Result<(), Error> {
    if required.holds && value.is_finite() {
        return Ok(());
    }
    Err(Error::Parameter { parameter: parameter.to_owned(), value, allowed: required.words.into() })
}
