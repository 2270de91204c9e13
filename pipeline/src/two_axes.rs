//! The traverse axis under the elevation axis: its project, its own design and verification, and both axes verified together.

use counterpoise_export::File;
use counterpoise_models::Plant;
use counterpoise_models::base_motion::{BaseState, FeltMotion, base_of_felt};
use counterpoise_models::plant::SinCos;
use counterpoise_models::two_axes::{BodyInertia, Coupling, ElevatedBody};
use counterpoise_project::Project;
use counterpoise_project::resolve::platform::{MotionKind, PlatformSource};
use counterpoise_verify::{
    AxisPair, JointMachine, JointProcedure, JointVerification, Procedure, Road, VerifiedController,
    verify_two_axes,
};

use crate::exchange::{VerifiedLoop, verified_loop};
use crate::export::{ExportTask, ExportedCode, HeaderWords, OmittedCode, export_by};
use crate::traverse_file::{FolderOfFile, check_axes, traverse_project};
use crate::verify::platform_motion;
use crate::{PipelineError, PlantModel, ProjectIdentity, SynthesisedDesign, World};
use crate::{build_plant_model, choose_and_tune, project_procedure, reduce_plant, synthesise, verify_on};

/// The traverse axis of a project, designed and verified alone.
#[derive(Debug, Clone)]
pub struct TraverseDesign {
    /// Project, with nothing left open.
    pub project: Project,
    /// Identity of that project.
    pub identity: ProjectIdentity,
    /// Plant.
    pub modelled: PlantModel,
    /// Design.
    pub synthesised: SynthesisedDesign,
    /// Procedure of its verification alone.
    pub procedure: Procedure,
    /// Controller, verified alone.
    pub verified: VerifiedController,
}

/// The traverse axis of a project with its code.
#[derive(Debug, Clone)]
pub struct TraverseCode {
    /// The axis.
    pub design: TraverseDesign,
    /// Code.
    pub files: Vec<File>,
    /// Code that its project asks for and cannot have.
    pub left_out: Vec<OmittedCode>,
}

/// An axis as the joint verification takes it.
#[derive(Debug, Clone, Copy)]
pub struct DesignedAxis<'a> {
    /// Project.
    pub project: &'a Project,
    /// Plant.
    pub plant: &'a Plant,
    /// Design.
    pub synthesised: &'a SynthesisedDesign,
    /// Procedure of its verification alone.
    pub procedure: &'a Procedure,
}

/// The traverse axis alone, and both axes together.
#[derive(Debug, Clone)]
pub struct TwoAxisStudy {
    /// The traverse axis.
    pub traverse: TraverseDesign,
    /// Loop on which the linear figures of the traverse axis were measured.
    pub traverse_loop: VerifiedLoop,
    /// Both axes together.
    pub joint: JointVerification,
}

impl TwoAxisStudy {
    /// Returns whether no requirement of the traverse axis or of both axes fails.
    pub fn passes(&self) -> bool {
        self.traverse.verified.verification().passes() && self.joint.passes()
    }
}

/// Designs and verifies the traverse axis of a project alone; `None` if it has none.
///
/// # Errors
/// A file of the traverse axis that cannot be read or has errors, axes that do not fit together, and those of the stages.
pub fn design_traverse(
    project: &Project,
    world: &dyn World,
) -> Result<Option<TraverseDesign>, PipelineError> {
    let Some(axis) = &project.traverse else { return Ok(None) };
    let below = FolderOfFile::of(&axis.file, world);
    let stated = traverse_project(axis, world)?;
    check_axes(project, &stated, &axis.file)?;
    let traverse = choose_and_tune(&stated, &below)?.project;
    let modelled = build_plant_model(&traverse)?;
    let reduced = reduce_plant(&traverse, &modelled)?;
    let synthesised = synthesise(&traverse, &modelled, &reduced)?;
    let procedure = project_procedure(&traverse, &below)?;
    let verified = verify_on(&traverse, &modelled.plant, &synthesised, &procedure)?;
    let identity = ProjectIdentity::of(&traverse, &below);
    Ok(Some(TraverseDesign { project: traverse, identity, modelled, synthesised, procedure, verified }))
}

/// Designs the traverse axis of a project and writes its code; `None` if it has none.
///
/// # Errors
/// As [`design_traverse`], and those of the export.
pub fn export_traverse(
    project: &Project,
    words: &dyn HeaderWords,
    world: &dyn World,
) -> Result<Option<TraverseCode>, PipelineError> {
    let (Some(axis), Some(design)) = (&project.traverse, design_traverse(project, world)?) else {
        return Ok(None);
    };
    let below = FolderOfFile::of(&axis.file, world);
    let TraverseDesign { project, modelled, verified, procedure, .. } = &design;
    let task = ExportTask { project, modelled, verified, procedure };
    let ExportedCode { files, left_out } = export_by(&task, words, &below)?;
    Ok(Some(TraverseCode { design, files, left_out }))
}

/// Verifies both axes of a project together on the motion of its base and on the steps of both; `None` if it has no traverse axis.
///
/// # Errors
/// As [`design_traverse`], a motion of the base that is not known enough, and those of the simulation.
pub fn study_two_axes(
    elevation: DesignedAxis,
    traverse: Option<TraverseDesign>,
    world: &dyn World,
) -> Result<Option<TwoAxisStudy>, PipelineError> {
    let (Some(axis), Some(traverse)) = (&elevation.project.traverse, traverse) else { return Ok(None) };
    let included = axis.included_at_rad.unwrap_or(elevation.project.model.operating_point.hub_angle_rad);
    let inertia = axis.inertia(BodyInertia::of_plant(elevation.plant));
    if !inertia.is_physical() {
        let problem = format!(
            "no body has the moments of inertia {} about its beam, {} about the normal and {} kg m^2 about the elevation axis with the product {}: \
             the product's square is at most that of beam times normal, and the axis' at most their sum; state beam_inertia and normal_inertia of [traverse]",
            inertia.about_beam_kg_m2,
            inertia.about_normal_kg_m2,
            inertia.about_axis_kg_m2,
            inertia.product_kg_m2
        );
        return Err(PipelineError::File { name: axis.file.clone(), section: "traverse", problem });
    }
    let body = ElevatedBody::of_plant(elevation.plant, inertia, axis.pivot, SinCos::of(included));
    let machine = JointMachine {
        plants: AxisPair { elevation: elevation.plant, traverse: &traverse.modelled.plant },
        controllers: AxisPair {
            elevation: &elevation.synthesised.sampled.controller,
            traverse: &traverse.synthesised.sampled.controller,
        },
        coupling: Coupling { body, gyroscope: axis.gyroscope },
    };
    let both = joint_procedure(elevation.project, [elevation.procedure, &traverse.procedure], world)?;
    let joint = verify_two_axes(&machine, &both, &axis.requirements)?;
    let controller = traverse.verified.controller();
    let traverse_loop = verified_loop(&traverse.modelled.plant, controller, &traverse.procedure)?;
    Ok(Some(TwoAxisStudy { traverse, traverse_loop, joint }))
}

/// Returns what is done to both axes: the elevation project's motion of the base, and the step of each.
fn joint_procedure(
    project: &Project,
    [elevation, traverse]: [&Procedure; 2],
    world: &dyn World,
) -> Result<JointProcedure, PipelineError> {
    let gravity_m_s2 = project.plant.gravity_m_s2;
    let ring_rad = traverse.operating_point.hub_angle_rad;
    let source = project.verify.as_ref().and_then(|asked| asked.road.as_ref());
    let moved = match source {
        Some(source) => base_of_source(source, ring_rad, gravity_m_s2, world)?,
        None if ring_rad != 0.0 => return Err(PipelineError::PlaneMotion { ring_rad }),
        None => base_of_sines(project, elevation),
    };
    let duration_s = moved.states.len() as f64 * moved.period_s;
    Ok(JointProcedure {
        base: moved.states,
        base_period_s: moved.period_s,
        duration_s,
        settle_s: elevation.settle_s,
        steps: AxisPair { elevation: elevation.step, traverse: traverse.step },
        start_rad: AxisPair { elevation: elevation.operating_point.hub_angle_rad, traverse: ring_rad },
        // the sensors of the axes do not share their noise
        seeds: AxisPair { elevation: elevation.seed, traverse: traverse.seed ^ TRAVERSE_NOISE },
    })
}

/// The number that tells the seed of the traverse axis' noise from that of the elevation axis where both files have the same.
const TRAVERSE_NOISE: u64 = 1 << 40;

/// Motion of the base in samples.
struct BaseSamples {
    states: Vec<BaseState>,
    period_s: f64,
}

/// Returns heave and pitch as the procedure's sines.
fn base_of_sines(project: &Project, procedure: &Procedure) -> BaseSamples {
    let period_s = project.plant.interface.sample_period_s;
    let samples = (procedure.duration_s / period_s) as usize;
    let sine = |sine: &counterpoise_verify::Sine, t: f64| {
        sine.amplitude * (std::f64::consts::TAU * sine.frequency_hz * t).sin()
    };
    let felt: Vec<FeltMotion> = (0..samples)
        .map(|k| k as f64 * period_s)
        .map(|t| FeltMotion {
            heave_m_s2: sine(&procedure.heave, t),
            pitch_rate_rad_s: sine(&procedure.pitch, t),
            ..FeltMotion::default()
        })
        .collect();
    BaseSamples { states: base_of_felt(&felt, None, period_s, project.plant.gravity_m_s2), period_s }
}

/// Returns the motion of the base from what an elevation axis feels of it that points forward, and one that points to the left.
fn base_of_source(
    source: &PlatformSource,
    ring_rad: f64,
    gravity_m_s2: f64,
    world: &dyn World,
) -> Result<BaseSamples, PipelineError> {
    let turned = |angle_rad: f64| turned_source(source, angle_rad, ring_rad);
    let forward = platform_motion(&turned(0.0)?.unwrap_or_else(|| source.clone()), world, gravity_m_s2)?;
    let left = turned(std::f64::consts::FRAC_PI_2)?;
    let left = left.map(|source| platform_motion(&source, world, gravity_m_s2)).transpose()?;
    let period_s = forward.sample_period_s;
    let left = left.as_ref().map(felt_of);
    Ok(BaseSamples {
        states: base_of_felt(&felt_of(&forward), left.as_deref(), period_s, gravity_m_s2),
        period_s,
    })
}

/// Returns a source as an elevation axis on a ring at an angle feels it; `None` if the base moves in a plane alone.
fn turned_source(
    source: &PlatformSource,
    angle_rad: f64,
    ring_rad: f64,
) -> Result<Option<PlatformSource>, PipelineError> {
    let mut turned = source.clone();
    let traverse = match &mut turned {
        PlatformSource::InertialUnit(unit) => &mut unit.traverse,
        PlatformSource::Made(motion) => match &mut motion.kind {
            MotionKind::SixAxes(axes) => &mut axes.traverse,
            MotionKind::Sea(sea) => &mut sea.traverse,
            MotionKind::IsoRoad { .. } => return Err(PipelineError::PlaneRoad),
            MotionKind::Spectrum { .. } | MotionKind::Simulator { .. } => return forward_alone(ring_rad),
        },
        PlatformSource::Recording(_) => return forward_alone(ring_rad),
    };
    if traverse.angle_rad != ring_rad || traverse.rate_rad_s != 0.0 {
        return Err(PipelineError::RingAngle { road_rad: traverse.angle_rad, ring_rad });
    }
    traverse.angle_rad = angle_rad;
    Ok(Some(turned))
}

/// A motion of pitch, heave and surge alone belongs to a ring that points forward.
fn forward_alone(ring_rad: f64) -> Result<Option<PlatformSource>, PipelineError> {
    if ring_rad == 0.0 { Ok(None) } else { Err(PipelineError::PlaneMotion { ring_rad }) }
}

fn felt_of(road: &Road) -> Vec<FeltMotion> {
    let of = |k: usize| {
        let further = road.has_further_motion().then(|| FeltMotion {
            surge_m_s2: road.surge_m_s2()[k],
            roll_rate_rad_s: road.roll_rate_rad_s()[k],
            yaw_rate_rad_s: road.yaw_rate_rad_s()[k],
            ..FeltMotion::default()
        });
        FeltMotion {
            heave_m_s2: road.heave_m_s2()[k],
            pitch_rate_rad_s: road.pitch_rate_rad_s()[k],
            ..further.unwrap_or_default()
        }
    };
    (0..road.signals.len()).map(of).collect()
}
