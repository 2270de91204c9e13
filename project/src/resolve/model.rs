//! The `[model]` section: which description of the plant the designs and verifications take, and where it stands.

use counterpoise_models::plant::{FrictionLinearisation, OperatingPoint};
use counterpoise_models::structure::{ElementMesh, FeOptions, Integration, Theory};

use crate::file::field::{Field, NumberRange};
use crate::file::visit::{NamedChoice, Visit, choose};

/// Selection of the plant.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantSelection {
    /// The description of the structure that is taken.
    pub structure: StructureChoice,
    /// Flexible modes that are kept where the structure is the beam.
    pub modes: usize,
    /// Division of the beam into elements; also used for lumped inertias that are derived from it.
    pub elements: FeOptions,
    /// Name of the configuration; `None` for the bare mechanism.
    pub configuration: Option<String>,
    /// Operating point of the mechanism.
    pub operating_point: OperatingPoint,
    /// Linear replacement of dry friction.
    pub friction: FrictionLinearisation,
}

/// Selection of the description of the structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StructureChoice {
    /// Two inertias.
    Lumped,
    /// The beam by finite elements, with its modes.
    Beam,
    /// Matrices of a finite-element package, with their modes.
    Import,
}

impl NamedChoice for StructureChoice {
    const NAMES: &'static [(&'static str, Self)] =
        &[("lumped", Self::Lumped), ("beam", Self::Beam), ("import", Self::Import)];
}

impl NamedChoice for Theory {
    const NAMES: &'static [(&'static str, Self)] =
        &[("bernoulli-euler", Self::BernoulliEuler), ("timoshenko", Self::Timoshenko)];
}

impl NamedChoice for Integration {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("quadrature", Self::Quadrature),
        ("power-law", Self::PowerLaw),
        ("uniform-average", Self::UniformAverage),
    ];
}

/// The treatment of dry friction in a linear plant, by name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum FrictionLinearisationName {
    Viscous,
    DescribingFunction,
}

impl NamedChoice for FrictionLinearisationName {
    const NAMES: &'static [(&'static str, Self)] =
        &[("viscous", Self::Viscous), ("describing-function", Self::DescribingFunction)];
}

/// Elements of the beam where the file does not say.
const ELEMENTS: u32 = 24;
/// Flexible modes where the file does not say.
const MODES: u32 = 3;

impl Default for PlantSelection {
    /// Returns the lumped plant, level, nothing fitted, dry friction left out of linear plants.
    fn default() -> Self {
        Self {
            structure: StructureChoice::Lumped,
            modes: MODES as usize,
            elements: FeOptions { mesh: ElementMesh::Pivoted(ELEMENTS as usize), ..FeOptions::default() },
            configuration: None,
            operating_point: OperatingPoint::default(),
            friction: FrictionLinearisation::Viscous,
        }
    }
}

/// Reads or lists the choice of plant.
pub(crate) fn model(v: &mut dyn Visit, model: &mut PlantSelection) {
    choose(
        v,
        &Field::new("structure", "the description of the structure that is used").or_text("lumped"),
        &mut model.structure,
    );
    count(
        v,
        &Field::new("modes", "number of flexible modes that are kept of the beam or the matrices")
            .limit(NumberRange::Between(0.0, 40.0))
            .or(f64::from(MODES)),
        &mut model.modes,
    );
    let ElementMesh::Pivoted(elements) = &mut model.elements.mesh else { return };
    count(
        v,
        &Field::new("elements", "number of finite elements of the beam")
            .limit(NumberRange::Between(2.0, 1000.0))
            .or(f64::from(ELEMENTS)),
        elements,
    );
    choose(
        v,
        &Field::new("theory", "beam theory of the elements").or_text("bernoulli-euler"),
        &mut model.elements.theory,
    );
    choose(
        v,
        &Field::new("integration", "how the cross section of an element is averaged").or_text("quadrature"),
        &mut model.elements.integration,
    );
    let mut name = model.configuration.take().unwrap_or_default();
    v.text(
        &Field::new(
            "configuration",
            "name of the configuration of the plant that is modelled; the bare mechanism if empty",
        )
        .or_text(""),
        &mut name,
    );
    model.configuration = (!name.is_empty()).then_some(name);
    let (angle, whole_turn) = (NumberRange::Between(-1.5, 1.5), NumberRange::Between(-3.15, 3.15));
    v.number(
        &Field::new("hub_angle", "angle of the hub against the horizontal")
            .unit("rad")
            .limit(whole_turn)
            .or(0.0),
        &mut model.operating_point.hub_angle_rad,
    );
    v.number(
        &Field::new("platform_angle", "angle of the platform against the horizontal")
            .unit("rad")
            .limit(angle)
            .or(0.0),
        &mut model.operating_point.platform_angle_rad,
    );
    friction(v, &mut model.friction);
}

fn friction(v: &mut dyn Visit, friction: &mut FrictionLinearisation) {
    let (mut dry, mut amplitude, mut frequency) = match *friction {
        FrictionLinearisation::Viscous | FrictionLinearisation::Impedances { .. } => {
            (FrictionLinearisationName::Viscous, f64::NAN, f64::NAN)
        }
        FrictionLinearisation::DescribingFunction { hub_amplitude_rad, frequency_rad_s } => {
            (FrictionLinearisationName::DescribingFunction, hub_amplitude_rad, frequency_rad_s)
        }
    };
    choose(
        v,
        &Field::new("friction", "how dry friction enters the linear plant").or_text("viscous"),
        &mut dry,
    );
    *friction = match dry {
        FrictionLinearisationName::Viscous => FrictionLinearisation::Viscous,
        FrictionLinearisationName::DescribingFunction => {
            let above = NumberRange::Above(0.0);
            v.number(
                &Field::new("friction_amplitude", "amplitude of the hub's motion on the platform")
                    .unit("rad")
                    .limit(above),
                &mut amplitude,
            );
            v.number(
                &Field::new("friction_frequency", "frequency of that motion").unit("rad/s").limit(above),
                &mut frequency,
            );
            FrictionLinearisation::DescribingFunction {
                hub_amplitude_rad: amplitude,
                frequency_rad_s: frequency,
            }
        }
    };
}

/// A whole number that counts things.
pub(crate) fn count(v: &mut dyn Visit, field: &Field, value: &mut usize) {
    let mut whole = u32::try_from(*value).unwrap_or(u32::MAX);
    v.whole_number(field, &mut whole);
    *value = whole as usize;
}
