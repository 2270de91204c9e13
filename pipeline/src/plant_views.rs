//! The views of a plant for a reader: the modes of its structure, and its friction at motor and pivot.

use counterpoise_diagnose::learning::reading::{ReadElement, read_elements};
use counterpoise_models::friction::FrictionModel;
use counterpoise_models::friction::describing_function::sinusoidal_loop;
use counterpoise_models::structure::refinement::{
    COLUMNS, REFERENCE, Refinement, RefinementMesh, compare_refinements,
};
use counterpoise_models::structure::{Direction, FeModel, Integration, Modes, Support, undamped_modes};
use counterpoise_models::{Beam, Friction, FrictionLaw};
use serde::Serialize;
use std::f64::consts::TAU;

use crate::tolerance::NEGLIGIBLE_MASS_SHARE;
use crate::{PipelineError, PlantModel, finite_elements, finite_elements_of};
use counterpoise_project::Project;

/// The modes, the friction, the free functions and the meshes of a plant as plain data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlantViews {
    /// The modes of the beam, one set a support; empty without a beam.
    pub modes: Vec<ModeSet>,
    /// The finite elements of which these are the modes; none without a flexible structure.
    #[serde(skip)]
    pub elements: Option<FeModel>,
    /// Frequencies of the beam with few elements; none without a beam.
    pub meshes: Option<MeshComparison>,
    /// Friction at the motor and at the pivot, if there is any.
    pub frictions: Vec<FrictionView>,
    /// The free functions of the plant, with their bands and the recordings' coverage.
    #[serde(skip)]
    pub learned: Vec<ReadElement>,
}

/// Comparison of a beam of few elements with one of many, free at both ends: the columns of the thesis' table 6-1.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshComparison {
    /// Elements of the model that is compared with.
    pub reference: usize,
    /// Flexible frequencies, Hz.
    pub reference_hz: Vec<f64>,
    /// The columns of the table.
    pub columns: Vec<MeshColumn>,
    /// Meshes that grow finer, of uniform and of tapered elements.
    pub finer: Vec<MeshColumn>,
}

/// Frequencies of one mesh over the reference's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshColumn {
    /// `uniform` or `tapered`.
    pub kind: &'static str,
    /// Number of elements.
    pub elements: usize,
    /// Ratio of frequencies, mode by mode.
    pub ratios: Vec<f64>,
}

impl MeshColumn {
    /// Returns by how much the frequency of a mode is off, relative to the reference's; `None` if the mesh has no such mode.
    pub fn relative_error(&self, mode: usize) -> Option<f64> {
        Some((self.ratios.get(mode)? - 1.0).abs())
    }
}

/// The first modes of a structure held in one way.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeSet {
    /// `free`, `pinned` or `clamped` at the hub.
    pub support: &'static str,
    /// The flexible modes, rising.
    pub modes: Vec<PlantMode>,
}

/// A flexible mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlantMode {
    /// Natural frequency, Hz.
    pub frequency_hz: f64,
    /// Effective mass in heave, kg.
    pub effective_mass_kg: f64,
    /// Effective inertia in pitch, kg m^2.
    pub effective_inertia_kg_m2: f64,
    /// Distance from the pivot (m) and deflection, the largest being 1.
    pub shape: Vec<[f64; 2]>,
}

/// Friction at one place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrictionView {
    /// `motor` or `pivot`.
    pub place: &'static str,
    /// Relative rate (rad/s) and steady torque (N m).
    pub steady: Vec<[f64; 2]>,
    /// Settled loops under sinusoidal motion, the swing rising through presliding into sliding.
    pub loops: Vec<FrictionLoop>,
}

/// A settled loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrictionLoop {
    /// Amplitude of the motion, rad.
    pub amplitude_rad: f64,
    /// Angle (rad) and torque (N m).
    pub points: Vec<[f64; 2]>,
    /// Rate (rad/s) and torque (N m).
    pub over_rate: Vec<[f64; 2]>,
    /// Energy lost in a period, J.
    pub lost_j: f64,
    /// Largest torque, N m.
    pub largest_torque_nm: f64,
    /// Viscous damping that loses as much, N m s/rad.
    pub equivalent_damping_nm_s_rad: f64,
}

impl FrictionLoop {
    /// Returns the torque (N m) over the angle, as a share of the loop's largest.
    pub fn torque_against_relative_angle(&self) -> Vec<[f64; 2]> {
        over_largest(&self.points)
    }

    /// Returns the torque (N m) over the rate, as a share of the loop's largest.
    pub fn torque_against_relative_rate(&self) -> Vec<[f64; 2]> {
        over_largest(&self.over_rate)
    }
}

fn over_largest(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let largest = points.iter().map(|[x, _]| x.abs()).fold(f64::MIN_POSITIVE, f64::max);
    points.iter().map(|[x, torque]| [x / largest, *torque]).collect()
}

/// Flexible modes that are shown.
const SHOWN: usize = 4;
/// Largest hub rate on the platform that is shown, rad/s; the motor turns by the gear's ratio faster.
const SHOWN_RATE_RAD_S: f64 = 0.3;
/// Points on each side of rest; they lie as the cube of an even grid, closer about rest.
const SIDE: i32 = 150;
/// Frequency of the loops, Hz.
const LOOP_HZ: f64 = 1.0;
/// Swings of the loops over the deflection at which presliding ends.
const SWINGS: [f64; 4] = [0.3, 1.0, 3.0, 10.0];
/// That deflection for laws that truly stick, which have none, rad at the hub.
const STICK_SWING_RAD: f64 = 1e-4;
/// Every so many of a loop's points are kept.
const KEPT: usize = 5;

/// Returns the modes, the friction and the meshes of the modelled plant.
///
/// # Errors
/// Those of the structure and the friction laws.
pub fn view_plant(project: &Project, modelled: &PlantModel) -> Result<PlantViews, PipelineError> {
    let meshes = project.plant.beam.as_ref().map(meshes).transpose()?;
    let mut out =
        PlantViews { modes: Vec::new(), elements: None, meshes, frictions: Vec::new(), learned: Vec::new() };
    out.learned = read_elements(&modelled.parameters.learned);
    if let Some(structure) = finite_elements_of(project) {
        let fe = match &modelled.elements {
            Some(fe) => fe.clone(),
            None => finite_elements(project, structure)?.0,
        };
        let supports = [(Support::Free, "free"), (Support::Pinned, "pinned"), (Support::Clamped, "clamped")];
        for (support, name) in supports {
            out.modes
                .push(ModeSet { support: name, modes: lowest_modes(&fe, &undamped_modes(&fe, support)?) });
        }
        out.elements = Some(fe);
    }
    let p = &modelled.parameters;
    let places = [("motor", &p.motor_friction, p.gearbox.ratio), ("pivot", &p.pivot_friction, 1.0)];
    for (place, friction, ratio) in places {
        if friction.law != FrictionLaw::None || friction.viscous_nm_s_rad != 0.0 {
            out.frictions.push(view_friction(place, friction, ratio)?);
        }
    }
    Ok(out)
}

fn meshes(beam: &Beam) -> Result<MeshComparison, PipelineError> {
    let finer = FINER
        .iter()
        .flat_map(|&elements| KINDS.map(|(integration, _)| RefinementMesh { integration, elements }));
    let asked: Vec<RefinementMesh> = COLUMNS.iter().copied().chain(finer).collect();
    let found = compare_refinements(beam, &asked)?;
    let named = |r: Refinement| MeshColumn {
        kind: KINDS.iter().find(|(kind, _)| *kind == r.integration).map_or("", |(_, name)| name),
        elements: r.elements,
        ratios: r.ratios.into_iter().take(TABLED).collect(),
    };
    let mut columns: Vec<MeshColumn> = found.columns.into_iter().map(named).collect();
    let finer = columns.split_off(COLUMNS.len());
    let reference_hz = found.reference_rad_s.iter().take(TABLED).map(|w| w / TAU).collect();
    Ok(MeshComparison { reference: REFERENCE, reference_hz, columns, finer })
}

/// Kinds of elements by name.
const KINDS: [(Integration, &str); 2] =
    [(Integration::UniformAverage, "uniform"), (Integration::Quadrature, "tapered")];
/// Modes of the table of meshes.
const TABLED: usize = 9;
/// Elements of the meshes that grow finer.
const FINER: [usize; 7] = [3, 5, 8, 12, 18, 28, 42];

fn lowest_modes(fe: &FeModel, all: &Modes) -> Vec<PlantMode> {
    let masses = all.effective_mass(fe, Direction::Heave);
    let inertias = all.effective_mass(fe, Direction::Pitch);
    let count = all.flexible_rad_s().len().min(SHOWN);
    let mode = |k: usize| PlantMode {
        frequency_hz: all.flexible_rad_s()[k] / TAU,
        effective_mass_kg: above_rounding(masses[all.rigid + k], fe.mass_kg()),
        effective_inertia_kg_m2: above_rounding(inertias[all.rigid + k], fe.inertia_kg_m2()),
        shape: scale_deflections(fe, all.flexible_shape(k)),
    };
    (0..count).map(mode).collect()
}

/// Returns an effective mass, or 0 if it is no more than rounding of the whole mass: the mode is then orthogonal to the rigid
/// motion.
fn above_rounding(mass: f64, whole: f64) -> f64 {
    if mass < NEGLIGIBLE_MASS_SHARE * whole { 0.0 } else { mass }
}

/// Deflections over the distance from the pivot, cubic between the nodes where their rotations are known.
fn scale_deflections(fe: &FeModel, shape: &[f64]) -> Vec<[f64; 2]> {
    // a deflection moves with heave and, by its arm, with pitch; a rotation with pitch alone, by 1
    let deflections: Vec<usize> = (0..shape.len()).filter(|&i| fe.heave[i] != 0.0).collect();
    let turns = |i: usize| fe.heave.get(i + 1) == Some(&0.0) && fe.pitch.get(i + 1) == Some(&1.0);
    let known = deflections.iter().all(|&i| turns(i));
    let node = |&i: &usize| [fe.pitch[i], shape[i], if known { shape[i + 1] } else { 0.0 }];
    let mut nodes: Vec<[f64; 3]> = deflections.iter().map(node).collect();
    nodes.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut points: Vec<[f64; 2]> = nodes.iter().take(1).map(|n| [n[0], n[1]]).collect();
    for two in nodes.windows(2) {
        match known {
            true => points.extend((1..=BETWEEN).map(|k| hermite(two, k as f64 / BETWEEN as f64))),
            false => points.push([two[1][0], two[1][1]]),
        }
    }
    let largest = points.iter().map(|p| p[1].abs()).fold(f64::MIN_POSITIVE, f64::max);
    points.iter_mut().for_each(|p| p[1] /= largest);
    points
}

/// Points of a shape from node to node.
const BETWEEN: usize = 5;

/// Returns the cubic between two nodes [place, deflection, slope] at a fraction of their distance.
fn hermite(two: &[[f64; 3]], s: f64) -> [f64; 2] {
    let ([x0, w0, t0], [x1, w1, t1]) = (two[0], two[1]);
    let l = x1 - x0;
    let third = s * s * (3.0 - 2.0 * s);
    let bend = l * (t0 * s * (1.0 - s) * (1.0 - s) + t1 * s * s * (s - 1.0));
    [x0 + l * s, w0 * (1.0 - third) + w1 * third + bend]
}

fn view_friction(
    place: &'static str,
    friction: &Friction,
    ratio: f64,
) -> Result<FrictionView, PipelineError> {
    let model = FrictionModel::new(friction)?;
    let rate = |k: i32| SHOWN_RATE_RAD_S * ratio * (f64::from(k) / f64::from(SIDE)).powi(3);
    let steady =
        (-SIDE..=SIDE).filter(|&k| k != 0).map(|k| [rate(k), model.steady_torque(rate(k))]).collect();
    let stiffness = model.rest_stiffness_nm_rad();
    let end = friction.coulomb_nm() / stiffness;
    let end = if end > 0.0 && end.is_finite() { end } else { STICK_SWING_RAD * ratio };
    let loops = match friction.law {
        FrictionLaw::None => Vec::new(),
        _ => SWINGS.iter().map(|swing| friction_loop(&model, swing * end)).collect(),
    };
    Ok(FrictionView { place, steady, loops })
}

fn friction_loop(model: &FrictionModel, amplitude_rad: f64) -> FrictionLoop {
    let found = sinusoidal_loop(model, amplitude_rad, TAU * LOOP_HZ);
    let closed = |x: &[f64]| -> Vec<[f64; 2]> {
        let kept = (0..x.len()).step_by(KEPT).chain([0]);
        kept.map(|k| [x[k], found.torque_nm[k]]).collect()
    };
    let points = closed(&found.angle_rad);
    FrictionLoop {
        amplitude_rad,
        largest_torque_nm: points.iter().map(|p| p[1].abs()).fold(0.0, f64::max),
        // a damper d loses pi d w a^2 in a period
        equivalent_damping_nm_s_rad: found.lost_j
            / (std::f64::consts::PI * TAU * LOOP_HZ * amplitude_rad.powi(2)),
        points,
        over_rate: closed(&found.rate_rad_s),
        lost_j: found.lost_j,
    }
}
