//! The `[traverse]` section: the traverse axis under the elevation axis, whose own project is another file, and what couples them.

use counterpoise_models::two_axes::{BodyInertia, PivotPosition, TraverseGyroscope};
use counterpoise_verify::{JointFigure, JointRequirement, Limit as Bound};

use crate::diagnostic::did_you_mean;
use crate::file::field::{Field, NumberRange, TableField};
use crate::file::visit::{NamedChoice, Visit, choose, list, maybe_number};

/// The traverse axis under the elevation axis.
#[derive(Debug, Clone, PartialEq)]
pub struct TraverseAxis {
    /// Name of its project file, beside that of the elevation axis.
    pub file: String,
    /// Position of the elevation pivot on the ring.
    pub pivot: PivotPosition,
    /// Elevation at which the traverse project's inertia and out-of-balance include the elevated body, rad; that of the model if absent.
    pub included_at_rad: Option<f64>,
    /// Place of the gyroscope of the traverse axis.
    pub gyroscope: TraverseGyroscope,
    /// Moment of inertia of the elevated body about its beam, kg m^2; 0 if absent, as a slender beam has it.
    pub beam_inertia_kg_m2: Option<f64>,
    /// Moment of inertia about the normal of the beam, kg m^2; that about the elevation axis if absent.
    pub normal_inertia_kg_m2: Option<f64>,
    /// Product of inertia of beam and normal, kg m^2.
    pub product_of_inertia_kg_m2: f64,
    /// Figures of both axes with their limits.
    pub requirements: Vec<JointRequirement>,
}

impl TraverseAxis {
    /// Returns the inertia of the elevated body of which a slender beam's is known.
    pub fn inertia(&self, slender: BodyInertia) -> BodyInertia {
        BodyInertia {
            about_beam_kg_m2: self.beam_inertia_kg_m2.unwrap_or(slender.about_beam_kg_m2),
            about_normal_kg_m2: self.normal_inertia_kg_m2.unwrap_or(slender.about_normal_kg_m2),
            product_kg_m2: self.product_of_inertia_kg_m2,
            ..slender
        }
    }
}

/// The place of the gyroscope of the traverse axis, as a file spells it.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Ring,
    ElevatedMass,
}

impl NamedChoice for Place {
    const NAMES: &'static [(&'static str, Self)] =
        &[("ring", Self::Ring), ("elevated-mass", Self::ElevatedMass)];
}

/// Farthest that a pivot is from the ring's axis, m.
const FARTHEST_M: NumberRange = NumberRange::Between(-100.0, 100.0);
const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);

/// Returns a traverse axis of which nothing is known yet.
pub(super) fn blank_axis() -> TraverseAxis {
    TraverseAxis {
        file: String::new(),
        pivot: PivotPosition::default(),
        included_at_rad: None,
        gyroscope: TraverseGyroscope::Ring,
        beam_inertia_kg_m2: None,
        normal_inertia_kg_m2: None,
        product_of_inertia_kg_m2: 0.0,
        requirements: Vec::new(),
    }
}

/// Reads or lists a traverse axis.
pub(super) fn visit_traverse_axis(v: &mut dyn Visit, axis: &mut TraverseAxis) {
    let file =
        "project file of the traverse axis, in the folder of this one: a machine of one axis with gravity 0";
    v.text(&Field::new("file", file), &mut axis.file);
    let leaves = axis.file.starts_with('/') || axis.file.split('/').any(|part| part == "..");
    if leaves || axis.file.chars().any(|c| c.is_control() || "\\:".contains(c)) {
        let allowed = "must be a file in the folder of this project or below it, with / between folders";
        v.complain("file", allowed, Some("move or copy the file there".to_owned()));
    } else if !axis.file.is_empty()
        && let Some(Err(why)) = v.attached_text(&axis.file)
    {
        v.complain("file", &format!("must be a project file that can be read: {why}"), None);
    }
    let forward = Field::new("pivot_forward", "the elevation pivot in front of the ring's axis").unit("m");
    v.number(&forward.limit(FARTHEST_M).or(0.0), &mut axis.pivot.forward_m);
    let left = Field::new("pivot_left", "the elevated body's plane to the left of the ring's axis").unit("m");
    v.number(&left.limit(FARTHEST_M).or(0.0), &mut axis.pivot.left_m);
    let included = "elevation at which the traverse project's inertia and out-of-balance include the elevated body; that of [model] if absent";
    let included = Field::new("included_at", included).unit("rad").limit(NumberRange::Between(-7.0, 7.0));
    maybe_number(v, &included, &mut axis.included_at_rad);
    gyroscope(v, &mut axis.gyroscope);
    let beam =
        Field::new("beam_inertia", "moment of inertia of the elevated body about its beam; 0 if absent");
    maybe_number(v, &beam.unit("kg m^2").limit(AT_LEAST_0), &mut axis.beam_inertia_kg_m2);
    let normal = "moment of inertia of the elevated body about the normal of its beam; that about the elevation axis if absent";
    let normal = Field::new("normal_inertia", normal).unit("kg m^2").limit(AT_LEAST_0);
    maybe_number(v, &normal, &mut axis.normal_inertia_kg_m2);
    let product = "product of inertia of the elevated body: the integral of the coordinates along beam and normal over its mass";
    let product = Field::new("product_of_inertia", product).unit("kg m^2").or(0.0);
    v.number(&product, &mut axis.product_of_inertia_kg_m2);
    requirements(v, &mut axis.requirements);
}

fn gyroscope(v: &mut dyn Visit, gyroscope: &mut TraverseGyroscope) {
    let mut place = match gyroscope {
        TraverseGyroscope::Ring => Place::Ring,
        TraverseGyroscope::ElevatedMass => Place::ElevatedMass,
    };
    let meaning = "where the gyroscope of the traverse axis is: on the ring, or on the elevated mass, where it reads the rate in cross-elevation";
    choose(v, &Field::new("gyroscope", meaning).or_text("ring"), &mut place);
    *gyroscope = match place {
        Place::Ring => TraverseGyroscope::Ring,
        Place::ElevatedMass => TraverseGyroscope::ElevatedMass,
    };
}

/// A requirement as the file has it.
#[derive(Debug, Clone)]
struct WrittenRequirement {
    figure: String,
    at_most: f64,
    source: String,
}

fn requirements(v: &mut dyn Visit, requirements: &mut Vec<JointRequirement>) {
    let asked_of = |one: &JointRequirement| WrittenRequirement {
        figure: one.figure.key(),
        at_most: one.limit.value(),
        source: one.source.clone(),
    };
    let mut asked: Vec<WrittenRequirement> = requirements.iter().map(asked_of).collect();
    let blank = WrittenRequirement { figure: String::new(), at_most: f64::NAN, source: String::new() };
    let field = TableField::optional("requirement", "a figure of both axes and its limit");
    list(v, &field, &mut asked, blank, requirement);
    let resolved = |one: &WrittenRequirement| {
        let figure = JointFigure::from_key(&one.figure)?;
        let limit = Some(one.at_most).filter(|limit| limit.is_finite()).map(Bound::AtMost)?;
        Some(JointRequirement { figure, limit, source: one.source.clone() })
    };
    *requirements = asked.iter().filter_map(resolved).collect();
}

fn requirement(v: &mut dyn Visit, asked: &mut WrittenRequirement) {
    v.text(&Field::new("figure", "name of the figure of both axes that is limited"), &mut asked.figure);
    let known = JointFigure::from_key(&asked.figure);
    if known.is_none() && !asked.figure.is_empty() {
        let keys: Vec<String> = JointFigure::all().map(|figure| figure.key()).collect();
        let hint = did_you_mean(&asked.figure, keys.iter().map(String::as_str));
        v.complain("figure", "there is no such figure of both axes", hint);
    }
    let unit = known.map_or("", |figure| figure.quantity.unit());
    v.number(
        &Field::new("at_most", "upper limit").unit(unit).limit(NumberRange::Above(0.0)),
        &mut asked.at_most,
    );
    let source = "where the requirement comes from, for example the clause of a specification";
    v.text(&Field::new("source", source).or_text(""), &mut asked.source);
}
