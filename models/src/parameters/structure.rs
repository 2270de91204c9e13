//! The structure: the beam with its sections and masses, the two-inertia description, and what a configuration fits.

/// The structure as a beam with sections and point masses. x grows towards the tip.
#[derive(Debug, Clone, PartialEq)]
pub struct Beam {
    /// Young's modulus, Pa.
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio; enters only if shear is modelled.
    pub poissons_ratio: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Position of the hub pivot along the beam axis, m.
    pub pivot_m: f64,
    /// Damping ratio of flexible mode 1, 2, ... of the structure pinned at its hub.
    pub modal_damping: Vec<f64>,
    /// Damping model of the structure.
    pub damping: StructuralDamping,
    /// Sections, adjoining, in order of position.
    pub sections: Vec<BeamSection>,
    /// Masses that can be fitted.
    pub masses: Vec<PointMass>,
}

/// Damping model of a structure.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum StructuralDamping {
    /// Damping ratios mode by mode; the last holds for all above: (5-13).
    #[default]
    Modal,
    /// Damping ratios mode by mode; above the last the ratio grows with the frequency, as stiffness damps: (5-14), corrected.
    ModalWithStiffness,
    /// C = a_0 M + a_1 K through two points, each a frequency (rad/s) and its damping ratio: (5-11), (5-12).
    Rayleigh {
        /// Frequency, rad/s, and damping ratio.
        first: [f64; 2],
        /// Frequency, rad/s, and damping ratio.
        second: [f64; 2],
    },
}

/// A stretch of the beam.
#[derive(Debug, Clone, PartialEq)]
pub struct BeamSection {
    /// Name for reports.
    pub name: String,
    /// Start and end along the axis, m.
    pub from_m: f64,
    /// End along the axis, m.
    pub to_m: f64,
    /// Cross section.
    pub shape: SectionShape,
}

/// The cross section of a stretch of the beam.
#[derive(Debug, Clone, PartialEq)]
pub enum SectionShape {
    /// A tube whose diameters vary linearly from the near to the far end.
    Tube {
        /// Outer diameter at the near and the far end, m.
        outer_diameter_m: [f64; 2],
        /// Inner diameter at the near and the far end, m (0 for solid).
        inner_diameter_m: [f64; 2],
    },
    /// A solid rectangle whose height (in the plane of bending) and width vary linearly from the near to the far end: a wedge, a
    /// tapered bar.
    Rectangle {
        /// Height at the near and the far end, m.
        height_m: [f64; 2],
        /// Width at the near and the far end, m.
        width_m: [f64; 2],
    },
    /// Area and second moment of area given, linear from the near to the far end.
    Given {
        /// Area at the near and the far end, m^2.
        area_m2: [f64; 2],
        /// Second moment of area at the near and the far end, m^4.
        second_moment_m4: [f64; 2],
    },
}

/// A point mass on the beam.
#[derive(Debug, Clone, PartialEq)]
pub struct PointMass {
    /// Name by which a configuration fits it.
    pub name: String,
    /// Position along the axis, m.
    pub position_m: f64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Own moment of inertia, kg m^2.
    pub inertia_kg_m2: f64,
}

/// The structure as hub and beam inertia joined by a torsional spring; one rigid inertia if the spring is infinitely stiff. Further
/// inertias may follow in a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct LumpedStructure {
    /// Inertia at the hub, kg m^2.
    pub hub_inertia_kg_m2: f64,
    /// Inertia of the beam, kg m^2; 0 if the structure is one inertia.
    pub beam_inertia_kg_m2: f64,
    /// Stiffness hub to beam, N m/rad; infinite if the structure is rigid.
    pub stiffness_nm_rad: f64,
    /// Damping hub to beam, N m s/rad.
    pub damping_nm_s_rad: f64,
    /// First moment of mass about the pivot, kg m, positive nose-heavy.
    pub out_of_balance_kg_m: f64,
    /// First moment of mass above the pivot axis, kg m.
    pub vertical_offset_kg_m: f64,
    /// Spring between hub and platform (a cable, a hose), N m/rad; 0 if there is none.
    pub position_stiffness_nm_rad: f64,
    /// Hub angle relative to the platform at which that spring is slack, rad.
    pub position_stiffness_centre_rad: f64,
    /// Largest torque of a hose between hub and platform that remembers how it was bent, N m; 0 if there is none.
    pub hysteresis_nm: f64,
    /// Stiffness of that hose when it springs back, N m/rad.
    pub hysteresis_stiffness_nm_rad: f64,
    /// Inertias that follow in a chain, each joined to the one before; the last one is the tip.
    pub chain: Vec<Link>,
}

/// An inertia of a chain, with the spring that joins it to the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// Inertia, kg m^2.
    pub inertia_kg_m2: f64,
    /// Stiffness to the inertia before, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Damping to the inertia before, N m s/rad.
    pub damping_nm_s_rad: f64,
}

impl LumpedStructure {
    /// Returns one rigid, balanced inertia.
    pub fn rigid(inertia_kg_m2: f64) -> Self {
        Self {
            hub_inertia_kg_m2: inertia_kg_m2,
            beam_inertia_kg_m2: 0.0,
            stiffness_nm_rad: f64::INFINITY,
            damping_nm_s_rad: 0.0,
            out_of_balance_kg_m: 0.0,
            vertical_offset_kg_m: 0.0,
            position_stiffness_nm_rad: 0.0,
            position_stiffness_centre_rad: 0.0,
            hysteresis_nm: 0.0,
            hysteresis_stiffness_nm_rad: 0.0,
            chain: Vec::new(),
        }
    }

    /// Returns whether hub and beam turn as one body.
    pub fn is_rigid(&self) -> bool {
        self.stiffness_nm_rad == f64::INFINITY || self.beam_inertia_kg_m2 == 0.0
    }

    /// Returns the inertia of the whole structure, kg m^2.
    pub fn inertia_kg_m2(&self) -> f64 {
        let chain: f64 = self.chain.iter().map(|link| link.inertia_kg_m2).sum();
        self.hub_inertia_kg_m2 + self.beam_inertia_kg_m2 + chain
    }
}

/// A way to load the mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// Name.
    pub name: String,
    /// Names of the beam's masses that are fitted.
    pub masses: Vec<String>,
    /// Inertia added at the hub without moment, kg m^2.
    pub added_hub_inertia_kg_m2: f64,
}
