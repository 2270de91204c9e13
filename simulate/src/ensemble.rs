//! Many runs at once: variants of one machine through their scenarios.
//!
//! Variants of one shape (the same kinds of friction, the same states) go through their samples side by side, four at a time; see
//! `lanes` for the method. What a variant leaves has the same bytes as [`Simulator::run`] gives, whatever runs beside it.

use crate::Error;
use crate::engine::present::Sample;
use crate::engine::stepper::Stepper;
use crate::history::{ReadingColumns, TimeHistory};
use crate::lanes::group::LaneGroup;
pub use crate::lanes::group::Registers;
use crate::lanes::number::LANES;
use crate::motion::{MotionSample, Track};
use crate::run::{HUB_ANGLE, Lap, Simulator};
use crate::scenario::Scenario;
use counterpoise_controller::SampledController;

/// A run of an ensemble.
pub struct Variant<'a> {
    /// The simulator of its plant.
    pub simulator: &'a mut Simulator,
    /// Its controller; it is used as it is handed in.
    pub controller: &'a mut dyn SampledController,
    /// Its scenario.
    pub scenario: &'a Scenario,
    /// When it is asked whether it goes on.
    pub watch: Option<Watch<'a>>,
}

/// A question that is asked of a run under way.
pub struct Watch<'a> {
    /// Samples from one question to the next.
    pub every: usize,
    /// Returns whether the run goes on, from the readings so far.
    pub goes_on: Box<dyn FnMut(&ReadingColumns) -> bool + 'a>,
}

/// Runs variants to their ends; returns what each leaves, in their order.
///
/// # Errors
/// Variant by variant, as [`Simulator::run`].
pub fn run_ensemble(variants: &mut [Variant]) -> Vec<Result<TimeHistory, Error>> {
    run_ensemble_in(Registers::Widest, variants)
}

/// Runs variants as [`run_ensemble`] does, in given registers: the bytes are the same in all.
///
/// # Errors
/// Variant by variant, as [`Simulator::run`].
pub fn run_ensemble_in(registers: Registers, variants: &mut [Variant]) -> Vec<Result<TimeHistory, Error>> {
    let mut results = Vec::with_capacity(variants.len());
    for four in variants.chunks_mut(LANES) {
        match <&mut [Variant; LANES]>::try_from(&mut *four) {
            Ok(four) => results.extend(run_four(registers, four)),
            Err(_) => results.extend(four.iter_mut().map(run_alone)),
        }
    }
    results
}

fn run_alone(variant: &mut Variant) -> Result<TimeHistory, Error> {
    let Variant { simulator, controller, scenario, watch } = variant;
    match watch {
        Some(Watch { every, goes_on }) => {
            simulator.run_while(&mut **controller, scenario, *every, &mut **goes_on)
        }
        None => simulator.run(&mut **controller, scenario),
    }
}

/// Runs four variants side by side if they are of one shape, and one after the other if not.
fn run_four(registers: Registers, variants: &mut [Variant; LANES]) -> [Result<TimeHistory, Error>; LANES] {
    let can_share = variants.iter().all(|variant| variant.scenario.platform.further.is_none());
    let mut steppers = variants.each_mut().map(|variant| variant.simulator.parts().1);
    let group = LaneGroup::new(&mut steppers, registers).filter(|_| can_share);
    match group {
        Some(group) => run_group(group, variants),
        None => variants.each_mut().map(run_alone),
    }
}

fn run_group(mut group: LaneGroup, variants: &mut [Variant; LANES]) -> [Result<TimeHistory, Error>; LANES] {
    let mut runs = variants.each_mut().map(Run::new);
    let mut platforms = Platforms::new(&runs);
    let mut k = 0;
    while runs.iter().any(|run| matches!(run.progress, Progress::UnderWay(_))) {
        for (lane, run) in runs.iter_mut().enumerate() {
            run.end_if_due(k, lane, &mut group);
        }
        let motions = platforms.next();
        let mut samples: [Option<Sample>; LANES] = [None; LANES];
        for (lane, run) in runs.iter_mut().enumerate() {
            samples[lane] = run.sample(k, lane, &group, platforms.of(lane, &motions));
        }
        let details = runs.each_ref().map(|run| run.scenario.detail);
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
    controller: &'a mut dyn SampledController,
    scenario: &'a Scenario,
    watch: Option<Question<'a>>,
    progress: Progress<'a>,
}

/// Samples from one question to the next, and the question: see [`Watch`].
type Question<'a> = (usize, &'a mut dyn FnMut(&ReadingColumns) -> bool);

/// How far a run is.
enum Progress<'a> {
    UnderWay(Box<Lap<'a>>),
    Ended(Result<TimeHistory, Error>),
}

impl<'a> Run<'a> {
    fn new<'b: 'a>(variant: &'a mut Variant<'b>) -> Self {
        let scenario = variant.scenario;
        let (plant, stepper, steps_per_sample) = variant.simulator.parts();
        let progress = match Lap::new(plant, scenario, stepper, steps_per_sample) {
            Ok(lap) => Progress::UnderWay(Box::new(lap)),
            Err(error) => Progress::Ended(Err(error)),
        };
        let watch: Option<Question> = match &mut variant.watch {
            Some(Watch { every, goes_on }) => Some((*every, &mut **goes_on)),
            None => None,
        };
        Self { stepper, controller: &mut *variant.controller, scenario, watch, progress }
    }

    /// Ends the run before sample k if it has no more samples, or if it is told not to go on.
    fn end_if_due(&mut self, k: usize, lane: usize, group: &mut LaneGroup) {
        let Progress::UnderWay(lap) = &mut self.progress else { return };
        let goes_on = match &mut self.watch {
            Some((every, goes_on)) if k > 0 && k.is_multiple_of((*every).max(1)) && k < lap.samples => {
                goes_on(lap.readings())
            }
            _ => true,
        };
        if k == lap.samples || !goes_on {
            group.leave(lane, self.stepper);
            self.progress = Progress::Ended(Ok(lap.history(self.stepper)));
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
        let Progress::UnderWay(lap) = &mut self.progress else { return None };
        let motion = motion?;
        let drive_v = lap.sample(k, self.controller, motion, &group.shown(lane, self.stepper));
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
        let Progress::UnderWay(lap) = &mut self.progress else { return };
        if let Some(dry_nm) = dry_nm {
            lap.log_friction(dry_nm);
        }
        lap.finish_sample(motion, group.shown(lane, self.stepper).outputs[HUB_ANGLE]);
        if let Err(error) = lap.check(k, self.stepper) {
            self.progress = Progress::Ended(Err(error));
        }
    }

    fn result(self) -> Result<TimeHistory, Error> {
        match self.progress {
            Progress::UnderWay(mut lap) => Ok(lap.history(self.stepper)),
            Progress::Ended(result) => result,
        }
    }
}

/// The platforms of the variants of a group: a motion that several share is followed once.
struct Platforms<'a> {
    /// The variant whose platform each variant is on.
    leads: [usize; LANES],
    tracks: [Option<(Track<'a>, f64)>; LANES],
}

impl<'a> Platforms<'a> {
    fn new(runs: &[Run<'a>; LANES]) -> Self {
        let laps = runs.each_ref().map(|run| match &run.progress {
            Progress::UnderWay(lap) => Some(lap),
            Progress::Ended(_) => None,
        });
        let shares = |a: usize, b: usize| {
            laps[a].is_some() && runs[a].scenario.platform == runs[b].scenario.platform
        };
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
