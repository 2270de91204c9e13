//! The structure: the beam with its sections and masses, the lumped inertias, the configurations.

use counterpoise_models::{
    Beam, BeamSection, Configuration, Link, LumpedStructure, PointMass, SectionShape, StructuralDamping,
};

use super::transmission::assumed_rigid;
use crate::file::field::{Field, NumberRange, TableField, UsualRange};
use crate::file::visit::{Count, NamedChoice, Visit, choose, list, pair};

const YOUNGS_MODULUS: Field =
    Field::new("youngs_modulus", "Young's modulus").unit("Pa").limit(NumberRange::Above(0.0));
const POISSONS_RATIO: Field = Field::new("poissons_ratio", "Poisson's ratio, used if shear is modelled")
    .limit(NumberRange::Between(-0.999, 0.5))
    .or(0.3);
const DENSITY: Field =
    Field::new("density", "density of the material").unit("kg/m^3").limit(NumberRange::Above(0.0));
const PIVOT: Field = Field::new("pivot", "position of the hub pivot along the axis; x grows towards the tip")
    .unit("m")
    .or(0.0);
const MODAL_DAMPING: Field = Field::new(
    "modal_damping",
    "damping ratios of flexible mode 1, 2, ... of the structure pinned at its hub; 0.01 for every mode if absent",
)
.limit(NumberRange::Between(0.0, 1.0))
.or_empty();
const DAMPING_LAW: Field = Field::new(
    "damping",
    "law of the damping above the last ratio that is given: constant (`modal`) or growing with the frequency (`modal-stiffness`)",
)
.or_text("modal");
const RAYLEIGH_FIRST: Field = Field::new("rayleigh_first", "frequency and damping ratio")
    .units("rad/s", "")
    .limit(NumberRange::AtLeast(0.0));
const RAYLEIGH_SECOND: Field =
    Field::new("rayleigh_second", "a higher frequency and the damping ratio there")
        .units("rad/s", "")
        .limit(NumberRange::AtLeast(0.0));
const SECTIONS: TableField = TableField::mandatory("section", "a section of the beam");
const MASSES: TableField = TableField::optional("mass", "a mass that can be fitted");

const NAME: Field = Field::new("name", "name");
const FROM: Field = Field::new("from", "position of the near end along the axis").unit("m");
const TO: Field = Field::new("to", "position of the far end along the axis").unit("m");
const SHAPE: Field = Field::new("shape", "how the cross section is given").or_text("tube");
const OUTER: Field = Field::new("outer_diameter", "outer diameter at the near and the far end")
    .unit("m")
    .limit(NumberRange::Above(0.0));
const INNER: Field =
    Field::new("inner_diameter", "inner diameter at the near and the far end; 0 for a solid section")
        .unit("m")
        .limit(NumberRange::AtLeast(0.0));
const HEIGHT: Field =
    Field::new("height", "height in the plane of bending at the near and the far end; 0 for a point")
        .unit("m")
        .limit(NumberRange::AtLeast(0.0));
const WIDTH: Field =
    Field::new("width", "width at the near and the far end").unit("m").limit(NumberRange::AtLeast(0.0));
const AREA: Field =
    Field::new("area", "area at the near and the far end").unit("m^2").limit(NumberRange::Above(0.0));
const SECOND_MOMENT: Field = Field::new("second_moment", "second moment of area at the near and the far end")
    .unit("m^4")
    .limit(NumberRange::Above(0.0));

const POSITION: Field = Field::new("position", "position along the axis").unit("m");
const MASS: Field = Field::new("mass", "mass").unit("kg").limit(NumberRange::Above(0.0));
const OWN_INERTIA: Field =
    Field::new("inertia", "own moment of inertia").unit("kg m^2").limit(NumberRange::AtLeast(0.0)).or(0.0);

const HUB_INERTIA: Field =
    Field::new("hub_inertia", "inertia at the hub").unit("kg m^2").limit(NumberRange::Above(0.0));
const BEAM_INERTIA: Field = Field::new("beam_inertia", "inertia of the beam; 0 if the structure is one body")
    .unit("kg m^2")
    .limit(NumberRange::AtLeast(0.0))
    .or(0.0);
const STIFFNESS: Field = Field::new("stiffness", "hub to beam; rigid if absent")
    .unit("N m/rad")
    .limit(NumberRange::Above(0.0))
    .or(f64::INFINITY);
/// Lowest usual frequency of a beam on its hub while the hub is held, Hz: a first design must hold a beam as soft as this if the file does not state how stiff
/// it is. The beam of the reference rig swings at 17 Hz.
const SOFT_BEAM_HZ: f64 = 10.0;
const DAMPING: Field = Field::new("damping", "hub to beam; damping ratio 0.01 if absent")
    .unit("N m s/rad")
    .limit(NumberRange::AtLeast(0.0));
const LINK_INERTIA: Field =
    Field::new("inertia", "of this part of the chain").unit("kg m^2").limit(NumberRange::Above(0.0));
const LINK_STIFFNESS: Field =
    Field::new("stiffness", "to the part before").unit("N m/rad").limit(NumberRange::Above(0.0));
const LINK_DAMPING: Field = Field::new("damping", "to the part before; damping ratio 0.01 if absent")
    .unit("N m s/rad")
    .limit(NumberRange::AtLeast(0.0));
const OUT_OF_BALANCE: Field =
    Field::new("out_of_balance", "first moment of mass about the pivot, positive nose-heavy")
        .unit("kg m")
        .or(0.0);
/// Damping ratio of a structure of which nothing is known.
const DAMPING_RATIO: f64 = 0.01;
const VERTICAL_OFFSET: Field =
    Field::new("vertical_offset", "first moment of mass above the pivot axis").unit("kg m").or(0.0);
const POSITION_STIFFNESS: Field = Field::new(
    "position_stiffness",
    "spring between hub and platform; negative if it pushes away from its centre",
)
.unit("N m/rad")
.or(0.0);
const POSITION_STIFFNESS_CENTRE: Field = Field::new(
    "position_stiffness_centre",
    "angle of the hub on the platform at which that spring has no torque",
)
.unit("rad")
.or(0.0);
const HYSTERESIS: Field = Field::new(
    "hysteresis",
    "largest torque of a hose between hub and platform whose bending has hysteresis",
)
.unit("N m")
.limit(NumberRange::AtLeast(0.0))
.or(0.0);
const HYSTERESIS_STIFFNESS: Field =
    Field::new("hysteresis_stiffness", "stiffness of that hose where its bending is reversed")
        .unit("N m/rad")
        .limit(NumberRange::AtLeast(0.0))
        .or(0.0);

const FITTED: Field = Field::new("masses", "names of the fitted masses").or_empty();
const ADDED_INERTIA: Field =
    Field::new("added_hub_inertia", "inertia added at the hub, without a first moment")
        .unit("kg m^2")
        .limit(NumberRange::AtLeast(0.0))
        .or(0.0);

/// The form in which a cross section is given.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Tube,
    Rectangle,
    Given,
}

/// The law of damping, by name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    Modal,
    ModalWithStiffness,
    Rayleigh,
}

impl NamedChoice for Law {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("modal", Self::Modal),
        ("modal-stiffness", Self::ModalWithStiffness),
        ("rayleigh", Self::Rayleigh),
    ];
}

impl NamedChoice for Shape {
    const NAMES: &'static [(&'static str, Self)] =
        &[("tube", Self::Tube), ("rectangle", Self::Rectangle), ("given", Self::Given)];
}

/// Returns a beam still to be read.
pub(crate) fn blank_beam() -> Beam {
    Beam {
        youngs_modulus_pa: f64::NAN,
        poissons_ratio: f64::NAN,
        density_kg_m3: f64::NAN,
        pivot_m: f64::NAN,
        modal_damping: Vec::new(),
        damping: StructuralDamping::Modal,
        sections: Vec::new(),
        masses: Vec::new(),
    }
}

/// Lumped inertias still to be read.
pub(crate) fn blank_lumped() -> LumpedStructure {
    LumpedStructure {
        hub_inertia_kg_m2: f64::NAN,
        beam_inertia_kg_m2: f64::NAN,
        stiffness_nm_rad: f64::NAN,
        damping_nm_s_rad: f64::NAN,
        out_of_balance_kg_m: f64::NAN,
        vertical_offset_kg_m: f64::NAN,
        position_stiffness_nm_rad: f64::NAN,
        position_stiffness_centre_rad: f64::NAN,
        hysteresis_nm: f64::NAN,
        hysteresis_stiffness_nm_rad: f64::NAN,
        chain: Vec::new(),
    }
}

/// Returns a configuration still to be read.
pub(crate) fn blank_configuration() -> Configuration {
    Configuration { name: String::new(), masses: Vec::new(), added_hub_inertia_kg_m2: 0.0 }
}

/// Reads or lists the beam.
pub(crate) fn beam(v: &mut dyn Visit, beam: &mut Beam) {
    v.number(&YOUNGS_MODULUS, &mut beam.youngs_modulus_pa);
    v.number(&POISSONS_RATIO, &mut beam.poissons_ratio);
    v.number(&DENSITY, &mut beam.density_kg_m3);
    v.number(&PIVOT, &mut beam.pivot_m);
    damping(v, beam);
    let blank = BeamSection {
        name: String::new(),
        from_m: f64::NAN,
        to_m: f64::NAN,
        shape: blank_shape(Shape::Tube),
    };
    list(v, &SECTIONS, &mut beam.sections, blank, section);
    masses(v, &mut beam.masses);
}

/// Reads or lists the masses that can be fitted.
pub(crate) fn masses(v: &mut dyn Visit, masses: &mut Vec<PointMass>) {
    let blank =
        PointMass { name: String::new(), position_m: f64::NAN, mass_kg: f64::NAN, inertia_kg_m2: 0.0 };
    list(v, &MASSES, masses, blank, mass);
}

fn damping(v: &mut dyn Visit, beam: &mut Beam) {
    let (mut law, mut first, mut second) = match beam.damping {
        StructuralDamping::Modal => (Law::Modal, [f64::NAN; 2], [f64::NAN; 2]),
        StructuralDamping::ModalWithStiffness => (Law::ModalWithStiffness, [f64::NAN; 2], [f64::NAN; 2]),
        StructuralDamping::Rayleigh { first, second } => (Law::Rayleigh, first, second),
    };
    choose(v, &DAMPING_LAW, &mut law);
    beam.damping = match law {
        Law::Rayleigh => {
            pair(v, &RAYLEIGH_FIRST, &mut first);
            pair(v, &RAYLEIGH_SECOND, &mut second);
            if first[0] <= 0.0 || second[0] <= first[0] {
                v.complain(
                    "rayleigh_second",
                    "must have a frequency above the first's, and both above 0",
                    None,
                );
            }
            StructuralDamping::Rayleigh { first, second }
        }
        Law::Modal => StructuralDamping::Modal,
        Law::ModalWithStiffness => StructuralDamping::ModalWithStiffness,
    };
    if law != Law::Rayleigh {
        v.numbers(&MODAL_DAMPING, Count::AtLeastOne, &mut beam.modal_damping);
        assumed_ratio(v, &MODAL_DAMPING, &mut beam.modal_damping);
    }
}

/// Assumes the damping ratio of a structure of which nothing is known, if none is written.
pub(crate) fn assumed_ratio(v: &mut dyn Visit, field: &Field, ratios: &mut Vec<f64>) {
    if ratios.is_empty() {
        ratios.push(DAMPING_RATIO);
        v.assume(&as_usual(*field), DAMPING_RATIO);
    }
}

fn section(v: &mut dyn Visit, section: &mut BeamSection) {
    v.text(&NAME, &mut section.name);
    v.number(&FROM, &mut section.from_m);
    v.number(&TO, &mut section.to_m);
    let mut shape = shape_of(&section.shape);
    choose(v, &SHAPE, &mut shape);
    if shape != shape_of(&section.shape) {
        section.shape = blank_shape(shape);
    }
    match &mut section.shape {
        SectionShape::Tube { outer_diameter_m, inner_diameter_m } => {
            pair(v, &OUTER, outer_diameter_m);
            pair(v, &INNER, inner_diameter_m);
        }
        SectionShape::Rectangle { height_m, width_m } => {
            pair(v, &HEIGHT, height_m);
            pair(v, &WIDTH, width_m);
        }
        SectionShape::Given { area_m2, second_moment_m4 } => {
            pair(v, &AREA, area_m2);
            pair(v, &SECOND_MOMENT, second_moment_m4);
        }
    }
}

fn shape_of(shape: &SectionShape) -> Shape {
    match shape {
        SectionShape::Tube { .. } => Shape::Tube,
        SectionShape::Rectangle { .. } => Shape::Rectangle,
        SectionShape::Given { .. } => Shape::Given,
    }
}

fn blank_shape(shape: Shape) -> SectionShape {
    let unread = [f64::NAN; 2];
    match shape {
        Shape::Tube => SectionShape::Tube { outer_diameter_m: unread, inner_diameter_m: unread },
        Shape::Rectangle => SectionShape::Rectangle { height_m: unread, width_m: unread },
        Shape::Given => SectionShape::Given { area_m2: unread, second_moment_m4: unread },
    }
}

fn mass(v: &mut dyn Visit, mass: &mut PointMass) {
    v.text(&NAME, &mut mass.name);
    v.number(&POSITION, &mut mass.position_m);
    v.number(&MASS, &mut mass.mass_kg);
    v.number(&OWN_INERTIA, &mut mass.inertia_kg_m2);
}

/// Reads or lists the lumped inertias.
pub(crate) fn lumped_inertias(v: &mut dyn Visit, lumped: &mut LumpedStructure) {
    v.number(&HUB_INERTIA, &mut lumped.hub_inertia_kg_m2);
    v.number(&BEAM_INERTIA, &mut lumped.beam_inertia_kg_m2);
    let stiffness = assumed_rigid(STIFFNESS, SOFT_BEAM_HZ, lumped.beam_inertia_kg_m2);
    v.number(&stiffness, &mut lumped.stiffness_nm_rad);
    // Of one body there is nothing that the rule of the damping could speak of.
    let damping = match lumped.is_rigid() {
        true => DAMPING.or(0.0),
        false => as_usual(DAMPING.or(usual_damping(lumped))),
    };
    v.number(&damping, &mut lumped.damping_nm_s_rad);
    v.number(&OUT_OF_BALANCE, &mut lumped.out_of_balance_kg_m);
    v.number(&VERTICAL_OFFSET, &mut lumped.vertical_offset_kg_m);
    v.number(&POSITION_STIFFNESS, &mut lumped.position_stiffness_nm_rad);
    v.number(&POSITION_STIFFNESS_CENTRE, &mut lumped.position_stiffness_centre_rad);
    v.number(&HYSTERESIS, &mut lumped.hysteresis_nm);
    v.number(&HYSTERESIS_STIFFNESS, &mut lumped.hysteresis_stiffness_nm_rad);
    let mut before = [lumped.beam_inertia_kg_m2, lumped.hub_inertia_kg_m2];
    if lumped.is_rigid() {
        before = [before[0] + before[1]; 2];
    }
    chain(v, &mut lumped.chain, before[0]);
}

/// Reads or lists the inertias that follow in a chain; `before` is the last one before them.
fn chain(v: &mut dyn Visit, chain: &mut Vec<Link>, before: f64) {
    let section =
        TableField::optional("chain", "inertias that follow in a chain, each joined to the one before");
    let count = v.enter_list(&section, chain.len());
    let blank = Link { inertia_kg_m2: f64::NAN, stiffness_nm_rad: f64::NAN, damping_nm_s_rad: f64::NAN };
    chain.resize(count, blank);
    let mut before = before;
    for (index, link) in chain.iter_mut().enumerate() {
        v.enter_item(index);
        v.number(&LINK_INERTIA, &mut link.inertia_kg_m2);
        v.number(&LINK_STIFFNESS, &mut link.stiffness_nm_rad);
        let both = before * link.inertia_kg_m2 / (before + link.inertia_kg_m2);
        let damping = LINK_DAMPING.or(2.0 * DAMPING_RATIO * (link.stiffness_nm_rad * both).sqrt());
        v.number(&as_usual(damping), &mut link.damping_nm_s_rad);
        before = link.inertia_kg_m2;
        v.leave();
    }
    v.leave_list();
}

/// Returns the damping of a structure of which nothing is known.
fn as_usual(damping: Field) -> Field {
    damping.with_assumption(
        "damping ratio 0.01",
        "welded or bolted metal structures: 0.005 to 0.03",
        UsualRange::Factors(0.5, 3.0),
    )
}

/// Returns damping at a damping ratio of 0.01 of the free structure; 0 if it is one body.
fn usual_damping(lumped: &LumpedStructure) -> f64 {
    let (hub, beam) = (lumped.hub_inertia_kg_m2, lumped.beam_inertia_kg_m2);
    if lumped.is_rigid() {
        return 0.0;
    }
    2.0 * DAMPING_RATIO * (lumped.stiffness_nm_rad * hub * beam / (hub + beam)).sqrt()
}

/// Reads or lists a configuration.
pub(crate) fn configuration(v: &mut dyn Visit, configuration: &mut Configuration) {
    v.text(&NAME, &mut configuration.name);
    v.texts(&FITTED, &mut configuration.masses);
    v.number(&ADDED_INERTIA, &mut configuration.added_hub_inertia_kg_m2);
}
