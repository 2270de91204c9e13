//! The `[sweep]` section: which parameters vary, one at a time and all at once.

use counterpoise_verify::robustness::{
    Distribution, Family, PointLayout, Variation, VariedParameter, varied_parameters,
};

use super::Project;
use crate::assumption::KeyTolerance;
use crate::file::field::{Field, NumberRange, TableField};
use crate::file::visit::{Count, NamedChoice, Visit, choose, list};
use crate::tolerance::MOST_CAMPAIGN_SAMPLES;

/// A robustness campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustnessCampaign {
    /// Mechanisms of the Monte Carlo campaign.
    pub samples: usize,
    /// Seed.
    pub seed: u64,
    /// Layout of its points.
    pub layout: PointLayout,
    /// Parameters that vary together.
    pub variations: Vec<Variation>,
    /// Parameters that vary one at a time, with their factors.
    pub families: Vec<Family>,
    /// Relative error of any phase at the plant's input, in the linear worst case.
    pub input_error: f64,
    /// Relative error of any phase of the hub gyroscope's reading, in the linear worst case.
    pub output_error: f64,
}

impl NamedChoice for VariedParameter {
    const NAMES: &'static [(&'static str, Self)] = &NAMES;
}

/// The parameters' keys, the other way round.
const NAMES: [(&str, VariedParameter); varied_parameters::ALL.len()] = {
    let mut names = [("", VariedParameter::Inertia); varied_parameters::ALL.len()];
    let mut at = 0;
    while at < names.len() {
        names[at] = (varied_parameters::ALL[at].1, varied_parameters::ALL[at].0);
        at += 1;
    }
    names
};

/// A distribution by name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Uniform,
    LogUniform,
    Normal,
}

impl NamedChoice for Shape {
    const NAMES: &'static [(&'static str, Self)] =
        &[("uniform", Self::Uniform), ("log-uniform", Self::LogUniform), ("normal", Self::Normal)];
}

impl NamedChoice for PointLayout {
    const NAMES: &'static [(&'static str, Self)] =
        &[("latin-hypercube", Self::LatinHypercube), ("sobol", Self::Sobol)];
}

const POINTS: Field =
    Field::new("points", "how the mechanisms are distributed over the ranges").or_text("latin-hypercube");
const PARAMETER: Field = Field::new("parameter", "the parameter that varies, by a factor");
const SHAPE: Field =
    Field::new("distribution", "distribution of the factor; `normal` if `deviation` is given")
        .or_text("uniform")
        .show_default();
const LOW: Field = Field::new("low", "lowest factor on the parameter").limit(NumberRange::AtLeast(0.0));
const HIGH: Field = Field::new("high", "highest factor on the parameter").limit(NumberRange::Above(0.0));
const LOWEST_LOG: Field = LOW.limit(NumberRange::Above(0.0));
const DEVIATION: Field =
    Field::new("deviation", "standard deviation about 1; the distribution ends at three of them")
        .limit(NumberRange::AboveTo(0.0, 0.33));
const FACTORS: Field = Field::new("factors", "factors on the parameter, each a mechanism of its own")
    .limit(NumberRange::AtLeast(0.0));
/// Error of the plant's gain if none is stated.
const GAIN_ERROR: f64 = 0.1;
const INPUT_ERROR: Field = Field::new(
    "input_error",
    "relative error, of any phase, at the plant's input in the linear worst case; 0 for none",
)
.limit(NumberRange::Between(0.0, 1.0))
.or(GAIN_ERROR);
const OUTPUT_ERROR: Field = Field::new(
    "output_error",
    "relative error, of any phase, of the hub gyroscope's reading in the linear worst case; 0 for none",
)
.limit(NumberRange::Between(0.0, 1.0))
.or(GAIN_ERROR);

/// The keys of the plant whose tolerances a campaign can vary, with the parameters that they are.
const TOLERANCES: [(&str, VariedParameter); 27] = [
    ("plant.inertia", VariedParameter::HubInertia),
    ("plant.mass", VariedParameter::HubInertia),
    ("plant.lumped.hub_inertia", VariedParameter::HubInertia),
    ("plant.lumped.mass", VariedParameter::HubInertia),
    ("plant.lumped.beam_inertia", VariedParameter::BeamInertia),
    ("plant.lumped.tip_mass", VariedParameter::BeamInertia),
    ("plant.lumped.out_of_balance", VariedParameter::OutOfBalance),
    ("plant.lumped.stiffness", VariedParameter::StructureStiffness),
    ("plant.lumped.damping", VariedParameter::StructureDamping),
    ("plant.gearbox.backlash", VariedParameter::Backlash),
    ("plant.ball_screw.backlash", VariedParameter::Backlash),
    ("plant.gearbox.stiffness", VariedParameter::GearStiffness),
    ("plant.belt.stiffness", VariedParameter::GearStiffness),
    ("plant.cable.stiffness", VariedParameter::GearStiffness),
    ("plant.harmonic_drive.stiffness", VariedParameter::GearStiffness),
    ("plant.ball_screw.stiffness", VariedParameter::GearStiffness),
    ("plant.motor.inertia", VariedParameter::MotorInertia),
    ("plant.motor.torque_constant", VariedParameter::TorqueConstant),
    ("plant.motor.resistance", VariedParameter::Resistance),
    ("plant.friction.motor.coulomb", VariedParameter::MotorFriction),
    ("plant.friction.pivot.coulomb", VariedParameter::PivotFriction),
    ("plant.sensors.hub_gyro.natural_frequency", VariedParameter::GyroBandwidth),
    ("plant.sensors.tachometer.natural_frequency", VariedParameter::GyroBandwidth),
    ("plant.sensors.encoder.natural_frequency", VariedParameter::GyroBandwidth),
    ("plant.sensors.resolver.natural_frequency", VariedParameter::GyroBandwidth),
    ("plant.sensors.platform_accelerometer.gain", VariedParameter::AccelerometerGain),
    ("plant.sensors.platform_gyro.gain", VariedParameter::PlatformGyroGain),
];

/// Returns the keys whose tolerances a campaign can vary.
pub(crate) fn keys_with_tolerances() -> impl Iterator<Item = &'static str> {
    TOLERANCES.iter().map(|(key, _)| *key)
}

/// A tolerance of a parameter that can be varied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VariedTolerance {
    /// Place among the tolerances of the project.
    pub place: usize,
    /// The parameter.
    pub parameter: VariedParameter,
    /// Half-width over the value.
    pub relative: f64,
}

impl Project {
    /// Returns the robustness campaign: the variations of the section `sweep`, and one for each tolerance whose parameter that
    /// section does not vary. `None` if there is neither.
    pub fn campaign(&self) -> Option<RobustnessCampaign> {
        let variations = self.variations_within_tolerances();
        let mut campaign = match (&self.sweep, variations.is_empty()) {
            (Some(sweep), _) => sweep.clone(),
            (None, false) => blank_campaign(),
            (None, true) => return None,
        };
        for variation in variations {
            if !campaign.variations.iter().any(|known| known.parameter == variation.parameter) {
                campaign.variations.push(variation);
            }
        }
        Some(campaign)
    }

    /// Returns the tolerances of parameters that can be varied, in the order of the file.
    pub fn varied_tolerances(&self) -> Vec<VariedTolerance> {
        let varied = |(place, tolerance): (usize, &KeyTolerance)| {
            let Variation { parameter, distribution } = variation_within(tolerance)?;
            let Distribution::Uniform { high, .. } = distribution else { return None };
            Some(VariedTolerance { place, parameter, relative: high - 1.0 })
        };
        self.tolerances.iter().enumerate().filter_map(varied).collect()
    }

    /// Returns the variation that each tolerance of a parameter means.
    pub fn variations_within_tolerances(&self) -> Vec<Variation> {
        self.tolerances.iter().filter_map(variation_within).collect()
    }
}

/// Returns the variation that a tolerance means.
fn variation_within(tolerance: &KeyTolerance) -> Option<Variation> {
    let (_, parameter) = TOLERANCES.iter().find(|(key, _)| *key == tolerance.key)?;
    let relative = (tolerance.value != 0.0).then(|| tolerance.half_width / tolerance.value.abs())?;
    let (low, high) = ((1.0 - relative).max(0.0), 1.0 + relative);
    Some(Variation { parameter: *parameter, distribution: Distribution::Uniform { low, high } })
}

/// Returns a campaign of which nothing is written.
pub(crate) fn blank_campaign() -> RobustnessCampaign {
    RobustnessCampaign {
        samples: 200,
        seed: 1,
        layout: PointLayout::LatinHypercube,
        variations: Vec::new(),
        families: Vec::new(),
        input_error: GAIN_ERROR,
        output_error: GAIN_ERROR,
    }
}

/// Reads or lists a campaign.
pub(crate) fn sweep(v: &mut dyn Visit, sweep: &mut RobustnessCampaign) {
    let samples = Field::new("samples", "number of mechanisms in which all parameters vary together")
        .limit(NumberRange::Between(1.0, MOST_CAMPAIGN_SAMPLES));
    super::model::count(v, &samples.or(200.0).show_default(), &mut sweep.samples);
    super::seed::seed(v, "seed of the campaign", &mut sweep.seed);
    choose(v, &POINTS, &mut sweep.layout);
    v.number(&INPUT_ERROR, &mut sweep.input_error);
    v.number(&OUTPUT_ERROR, &mut sweep.output_error);
    let blank = Variation {
        parameter: VariedParameter::Inertia,
        distribution: Distribution::Uniform { low: f64::NAN, high: f64::NAN },
    };
    list(
        v,
        &TableField::optional("variation", "a parameter that varies with the others"),
        &mut sweep.variations,
        blank,
        variation,
    );
    let blank = Family { parameter: VariedParameter::Inertia, factors: Vec::new() };
    list(
        v,
        &TableField::optional("family", "a parameter that varies alone"),
        &mut sweep.families,
        blank,
        family,
    );
}

fn variation(v: &mut dyn Visit, variation: &mut Variation) {
    choose(v, &PARAMETER, &mut variation.parameter);
    let (mut shape, mut low, mut high, mut deviation) = match variation.distribution {
        Distribution::Uniform { low, high } => (Shape::Uniform, low, high, f64::NAN),
        Distribution::LogUniform { low, high } => (Shape::LogUniform, low, high, f64::NAN),
        Distribution::Normal { deviation } => (Shape::Normal, f64::NAN, f64::NAN, deviation),
    };
    // Only a normal distribution has a deviation.
    let field = if v.has("deviation") { SHAPE.or_text("normal") } else { SHAPE };
    choose(v, &field, &mut shape);
    if shape == Shape::Normal {
        v.number(&DEVIATION, &mut deviation);
    } else {
        v.number(if shape == Shape::LogUniform { &LOWEST_LOG } else { &LOW }, &mut low);
        v.number(&HIGH, &mut high);
    }
    if low > high {
        v.complain("high", &format!("must not be below the lowest factor {low}"), None);
    }
    variation.distribution = match shape {
        Shape::Uniform => Distribution::Uniform { low, high },
        Shape::LogUniform => Distribution::LogUniform { low, high },
        Shape::Normal => Distribution::Normal { deviation },
    };
}

fn family(v: &mut dyn Visit, family: &mut Family) {
    choose(v, &PARAMETER, &mut family.parameter);
    v.numbers(&FACTORS, Count::AtLeastOne, &mut family.factors);
}
