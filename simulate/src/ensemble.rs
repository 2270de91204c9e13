//! Many runs at once: variants of one machine through their scenarios.
//!
//! Variants of one shape (the same kinds of friction, the same states) go through their samples side by side, four at a time; see
//! `lanes` for the method. What a variant leaves has the same bytes as [`Simulator::run`] gives, whatever runs beside it.

use crate::Error;
use crate::engine::present_plant::Sample;
use crate::engine::stepper::Stepper;
use crate::history::{ReadingColumns, TimeHistory};
pub use crate::lanes::group::Registers;
use crate::lanes::group::{LaneGroup, LaneShape};
use crate::lanes::number::LANES;
use crate::motion::{MotionSample, MotionTrack};
use crate::run::{HUB_ANGLE, Lap, Simulator};
use crate::scenario::{Detail, Scenario};
use crate::tolerance::FEWEST_LANES;
use counterpoise_controller::SampledController;
use counterpoise_models::DriveLimits;

/// Variants that go through their samples side by side: chunks of an ensemble for several processors have a multiple of it.
pub const SIDE_BY_SIDE: usize = LANES;

/// A run of an ensemble.
pub struct EnsembleRun<'a> {
    /// The simulator of its plant.
    pub simulator: &'a mut Simulator,
    /// Controller; it is used as it is handed in.
    pub controller: &'a mut dyn SampledController,
    /// Scenario.
    pub scenario: &'a Scenario,
    /// The times at which it is asked whether it goes on.
    pub watch: Option<RunObserver<'a>>,
}

/// A question that is asked of a run under way.
pub struct RunObserver<'a> {
    /// Samples from one question to the next.
    pub every: usize,
    /// Returns whether the run goes on, from the readings so far.
    pub goes_on: Box<dyn FnMut(&ReadingColumns) -> bool + 'a>,
}

/// Runs variants to their ends; returns what each leaves, in their order.
///
/// # Errors
/// Variant by variant, as [`Simulator::run`].
pub fn run_ensemble(variants: &mut [EnsembleRun]) -> Vec<Result<TimeHistory, Error>> {
    run_ensemble_in(Registers::Widest, variants)
}

/// Runs variants as [`run_ensemble`] does, in given registers: the bytes are the same in all.
///
/// # Errors
/// Variant by variant, as [`Simulator::run`].
pub fn run_ensemble_in(
    registers: Registers,
    variants: &mut [EnsembleRun],
) -> Vec<Result<TimeHistory, Error>> {
    let shapes: Vec<Option<LaneShape>> = variants.iter_mut().map(shape_of).collect();
    let mut found: Vec<Option<Result<TimeHistory, Error>>> = variants.iter().map(|_| None).collect();
    let mut waiting: Vec<Option<&mut EnsembleRun>> = variants.iter_mut().map(Some).collect();
    for first in 0..shapes.len() {
        // those of one shape that are still waiting go together, wherever they stand in the list
        let alike = (first..shapes.len()).filter(|&k| waiting[k].is_some() && shapes[k] == shapes[first]);
        let alike: Vec<usize> = match (&shapes[first], &waiting[first]) {
            (_, None) => Vec::new(),
            (None, Some(_)) => vec![first],
            (Some(_), Some(_)) => alike.take(LANES).collect(),
        };
        let mut few: Vec<&mut EnsembleRun> = alike.iter().filter_map(|&k| waiting[k].take()).collect();
        for (k, result) in alike.into_iter().zip(run_few(registers, &mut few)) {
            found[k] = Some(result);
        }
    }
    found.into_iter().flatten().collect()
}

/// Returns the shape of a variant; `None` if it runs alone.
fn shape_of(variant: &mut EnsembleRun) -> Option<LaneShape> {
    if can_share(variant) { LaneShape::of(variant.simulator.parts().1) } else { None }
}

fn run_alone(variant: &mut EnsembleRun) -> Result<TimeHistory, Error> {
    let EnsembleRun { simulator, controller, scenario, watch } = variant;
    match watch {
        Some(RunObserver { every, goes_on }) => {
            simulator.run_while(&mut **controller, scenario, *every, &mut **goes_on)
        }
        None => simulator.run(&mut **controller, scenario),
    }
}

/// Runs up to four variants of one shape side by side.
fn run_few(registers: Registers, variants: &mut [&mut EnsembleRun]) -> Vec<Result<TimeHistory, Error>> {
    let alone = |variants: &mut [&mut EnsembleRun]| variants.iter_mut().map(|one| run_alone(one)).collect();
    if variants.len() < FEWEST_LANES {
        return alone(variants);
    }
    // lanes without a variant have a plant that stands still
    let mut idle: Vec<Simulator> = (variants.len()..LANES).map(|_| variants[0].simulator.clone()).collect();
    let steppers = variants.iter_mut().map(|variant| variant.simulator.parts().1);
    let steppers = steppers.chain(idle.iter_mut().map(|simulator| simulator.parts().1));
    let group = take_four(steppers).and_then(|mut steppers| LaneGroup::new(&mut steppers, registers));
    let Some(group) = group else { return alone(variants) };
    let count = variants.len();
    let runs = variants.iter_mut().map(|one| Run::new(one)).chain(idle.iter_mut().map(Run::idle_lane));
    let finished = take_four(runs).map(|runs| run_group(group, runs));
    finished.into_iter().flatten().take(count).collect()
}

/// Returns whether a variant can run beside others: on a base that only heaves and pitches, and without loads and limits of the drive, whose
/// state belongs to a run alone.
fn can_share(variant: &EnsembleRun) -> bool {
    let plant = variant.simulator.plant();
    variant.scenario.platform.further.is_none()
        && plant.loads().is_none()
        && plant.parameters().drive_limits == DriveLimits::default()
}

/// Returns four items; `None` if there are not so many.
fn take_four<T>(items: impl Iterator<Item = T>) -> Option<[T; LANES]> {
    items.collect::<Vec<T>>().try_into().ok()
}

fn run_group(mut group: LaneGroup, mut runs: [Run; LANES]) -> [Result<TimeHistory, Error>; LANES] {
    let mut platforms = Platforms::new(&runs);
    let mut k = 0;
    while runs.iter().any(|run| matches!(run.progress, LaneState::UnderWay(_))) {
        for (lane, run) in runs.iter_mut().enumerate() {
            run.end_if_due(k, lane, &mut group);
        }
        let motions = platforms.next();
        let mut samples: [Option<Sample>; LANES] = [None; LANES];
        for (lane, run) in runs.iter_mut().enumerate() {
            samples[lane] = run.sample(k, lane, &group, platforms.of(lane, &motions));
        }
        let details = runs.each_ref().map(Run::detail);
        let mut steppers = runs.each_mut().map(|run| &mut *run.stepper);
        let dry_nm = group.advance(&mut steppers, &samples, &details);
        for (lane, run) in runs.iter_mut().enumerate() {
            if let Some(sample) = &samples[lane] {
                run.finish_sample(k, lane, &group, sample.motion, dry_nm[lane]);
            }
        }
        k += 1;
    }
    runs.map(Run::result)
}

/// One variant of a group.
struct Run<'a> {
    stepper: &'a mut Stepper,
    /// The controller that acts, and the scenario; `None` in a lane without a variant.
    asked: Option<(&'a mut dyn SampledController, &'a Scenario)>,
    watch: Option<Question<'a>>,
    progress: LaneState<'a>,
}

/// Samples from one question to the next, and the question: see [`RunObserver`].
type Question<'a> = (usize, &'a mut dyn FnMut(&ReadingColumns) -> bool);

/// The progress of a run.
enum LaneState<'a> {
    UnderWay(Box<Lap<'a>>),
    Ended(Box<Result<TimeHistory, Error>>),
}

impl<'a> Run<'a> {
    fn new<'b: 'a>(variant: &'a mut EnsembleRun<'b>) -> Self {
        let scenario = variant.scenario;
        let (plant, stepper, steps_per_sample) = variant.simulator.parts();
        let progress = match Lap::new(plant, scenario, stepper, steps_per_sample) {
            Ok(lap) => LaneState::UnderWay(Box::new(lap)),
            Err(error) => LaneState::Ended(Box::new(Err(error))),
        };
        let watch: Option<Question> = match &mut variant.watch {
            Some(RunObserver { every, goes_on }) => Some((*every, &mut **goes_on)),
            None => None,
        };
        Self { stepper, asked: Some((&mut *variant.controller, scenario)), watch, progress }
    }

    /// Returns a lane without a variant.
    fn idle_lane(simulator: &'a mut Simulator) -> Self {
        let error = Error::Length { what: "a lane without a variant", found: 0, expected: 1 };
        let progress = LaneState::Ended(Box::new(Err(error)));
        Self { stepper: simulator.parts().1, asked: None, watch: None, progress }
    }

    fn detail(&self) -> Detail {
        self.asked.as_ref().map_or(Detail::Recording, |(_, scenario)| scenario.detail)
    }

    /// Ends the run before sample k if it has no more samples, or if it is told not to go on.
    fn end_if_due(&mut self, k: usize, lane: usize, group: &mut LaneGroup) {
        let LaneState::UnderWay(lap) = &mut self.progress else { return };
        let goes_on = match &mut self.watch {
            Some((every, goes_on)) if k > 0 && k.is_multiple_of((*every).max(1)) && k < lap.samples => {
                goes_on(lap.readings())
            }
            _ => true,
        };
        if k == lap.samples || !goes_on {
            group.leave(lane, self.stepper);
            self.progress = LaneState::Ended(Box::new(Ok(lap.history(self.stepper))));
        }
    }

    /// Reads and controls at sample k; returns what acts on the plant until the next.
    fn sample<'m>(
        &mut self,
        k: usize,
        lane: usize,
        group: &LaneGroup,
        motion: Option<&'m MotionSample>,
    ) -> Option<Sample<'m>> {
        let LaneState::UnderWay(lap) = &mut self.progress else { return None };
        let motion = motion?;
        let (controller, _) = self.asked.as_mut()?;
        let drive_v = lap.sample(k, *controller, motion, &group.outputs_of(lane, self.stepper));
        Some(Sample { drive_v, start_s: lap.time(k), motion })
    }

    fn finish_sample(
        &mut self,
        k: usize,
        lane: usize,
        group: &LaneGroup,
        motion: &MotionSample,
        dry_nm: Option<[f64; 2]>,
    ) {
        let LaneState::UnderWay(lap) = &mut self.progress else { return };
        if let Some(dry_nm) = dry_nm {
            lap.log_friction(dry_nm);
        }
        lap.finish_sample(motion, group.outputs_of(lane, self.stepper).outputs[HUB_ANGLE]);
        if let Err(error) = lap.check(k, self.stepper) {
            self.progress = LaneState::Ended(Box::new(Err(error)));
        }
    }

    fn result(self) -> Result<TimeHistory, Error> {
        match self.progress {
            LaneState::UnderWay(mut lap) => Ok(lap.history(self.stepper)),
            LaneState::Ended(result) => *result,
        }
    }
}

/// The platforms of the variants of a group: a motion that several share is followed once.
struct Platforms<'a> {
    /// The variant whose platform each variant is on.
    leads: [usize; LANES],
    tracks: [Option<(MotionTrack<'a>, f64)>; LANES],
}

impl<'a> Platforms<'a> {
    fn new(runs: &[Run<'a>; LANES]) -> Self {
        let laps = runs.each_ref().map(|run| match &run.progress {
            LaneState::UnderWay(lap) => Some(lap),
            LaneState::Ended(_) => None,
        });
        let platforms = runs.each_ref().map(|run| run.asked.as_ref().map(|(_, scenario)| &scenario.platform));
        let shares = |a: usize, b: usize| laps[a].is_some() && platforms[a] == platforms[b];
        let leads: [usize; LANES] =
            std::array::from_fn(|lane| (0..lane).find(|&other| shares(other, lane)).unwrap_or(lane));
        let track = |lane: usize| {
            let lap = laps[lane].filter(|_| leads[lane] == lane)?;
            Some((lap.track.clone(), lap.angle))
        };
        Self { leads, tracks: std::array::from_fn(track) }
    }

    /// Returns the motions of the platforms that are followed over the next sample.
    fn next(&mut self) -> [Option<MotionSample>; LANES] {
        self.tracks.each_mut().map(|followed| {
            let (track, angle) = followed.as_mut()?;
            let motion = track.sample(*angle);
            *angle = motion.at(1.0).angle;
            Some(motion)
        })
    }

    /// Returns the motion of a variant's platform.
    fn of<'m>(&self, lane: usize, motions: &'m [Option<MotionSample>; LANES]) -> Option<&'m MotionSample> {
        motions[self.leads[lane]].as_ref()
    }
}
