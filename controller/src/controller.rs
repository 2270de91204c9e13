//! A checked controller.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

use crate::number::Dual;
use crate::program::Compiled;
use crate::signal::{COMMON_READINGS, DEMAND, HUB_RATE};
use crate::tolerance::LEARNT_AT_REST_S;
use crate::{
    Correction, Error, Estimator, Learning, Number, Parts, Programs, READINGS, Runner, check, lower,
};

/// A discrete controller whose arithmetic is fixed to the last bit. It cannot be changed: what was verified is what is
/// exported.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    parts: Parts,
    programs: Programs,
}

impl Controller {
    /// Checks the parts and fixes the order of the arithmetic.
    ///
    /// # Errors
    /// A number out of its range, a name that target code cannot carry, a system that does not fit its signals, its
    /// timebase or its anti-windup gains: see [`Error`].
    pub fn new(parts: Parts) -> Result<Self, Error> {
        check::parts(&parts)?;
        let programs = lower::programs(&parts);
        check::check_distinct(&programs)?;
        Ok(Self { parts, programs })
    }

    /// Returns what the controller is made of.
    pub fn parts(&self) -> &Parts {
        &self.parts
    }

    /// Returns the straight lines of arithmetic that every back end carries out.
    pub fn programs(&self) -> &Programs {
        &self.programs
    }

    /// Sample period, s.
    pub fn sample_period_s(&self) -> f64 {
        self.parts.sample_period_s
    }

    /// Returns the largest control, V: the control is limited to +/- this.
    pub fn limit_v(&self) -> f64 {
        self.parts.limit_v
    }

    /// Returns the controller at its start, in double: the reference.
    pub fn runner(&self) -> Runner {
        Runner::new(self)
    }

    /// Returns the controller at its start, in the numbers N.
    pub fn runner_in<N: Number>(&self) -> Runner<N> {
        Runner::new(self)
    }

    /// Returns the controller with some of its parts changed, checked again.
    ///
    /// # Errors
    /// As [`Controller::new`].
    pub fn with(&self, change: impl FnOnce(&mut Parts)) -> Result<Self, Error> {
        let mut parts = self.parts.clone();
        change(&mut parts);
        Self::new(parts)
    }

    /// Returns the linear part at a set out-of-balance: from the readings of every controller, in the order of [`crate::READING_NAMES`], to the
    /// control before the limiter, in volts of a linear drive. The program itself is differentiated at rest, so nothing can be left out. Friction
    /// observers are taken as sliding (their force constant) and the estimator as standing still. A [`Projection`](crate::Projection) is
    /// taken at the elevation of its design: as accelerations are 0 at rest, its derivative by the angle is 0. Its surge is no input: the linear loop takes
    /// surge as a heave of -surge tan(theta), which the projection answers as it answers both accelerometers.
    ///
    /// # Errors
    /// [`Error::System`] if the program does not give a finite system.
    pub fn linear(&self, out_of_balance_kg_m: f64) -> Result<StateSpace, Error> {
        let sliding = self.with(|parts| {
            parts.estimator = None;
            parts.observers.iter_mut().for_each(|observer| observer.volts_per_nm = 0.0);
            parts.bias_v_per_kg_m = 0.0;
            parts.drive_curve.clear();
            stand_at_design(parts);
        })?;
        let mut gains = Runner::<f64>::new(&sliding);
        gains.set_out_of_balance(out_of_balance_kg_m);
        let mut about = gains.states();
        let dynamic = sliding.dynamic_states();
        dynamic.iter().for_each(|&state| about[state] = 0.0);
        sliding.differentiate(&about, &dynamic)
    }

    /// Returns the controller that remains when feedback works alone: it reads the demand and the hub gyroscope, and 0 for every
    /// other sensor. What is verified of it holds for the exported code after its handover to feedback alone.
    ///
    /// # Errors
    /// As [`Controller::new`].
    pub fn feedback_alone(&self) -> Result<Self, Error> {
        self.with(|parts| {
            parts.corrections.retain(|each| each.reading == DEMAND || each.reading == HUB_RATE);
            let others =
                (0..parts.reading_count()).filter(|reading| *reading != DEMAND && *reading != HUB_RATE);
            let original = &self.parts.corrections;
            parts.corrections.extend(others.map(|reading| {
                let offset =
                    original.iter().find(|each| each.reading == reading).map_or(0.0, |each| each.offset);
                Correction { reading, gain: 0.0, offset }
            }));
        })
    }

    /// Returns the linear part as [`Controller::linear`] does, with the estimator of the out-of-balance learning: gains and bias
    /// follow its estimate. The program is differentiated about the state that it reaches at rest, the sizes of what a sample
    /// tells held there, and the estimate outside its hold band. A mean over windows stands still between the ends of its windows, and is left so.
    ///
    /// # Errors
    /// As [`Controller::linear`].
    pub fn linear_learning(&self, out_of_balance_kg_m: f64) -> Result<StateSpace, Error> {
        let learns = |estimator: &Estimator| !matches!(estimator.learning, Learning::Mean { .. });
        if !self.parts.estimator.as_ref().is_some_and(learns) {
            return self.linear(out_of_balance_kg_m);
        }
        let sliding = self.with(|parts| {
            parts.observers.iter_mut().for_each(|observer| observer.volts_per_nm = 0.0);
            parts.drive_curve.clear();
            parts.transfer_time_s = 0.0;
            stand_at_design(parts);
            parts.estimator.iter_mut().for_each(|estimator| estimator.hold_band_kg_m = 0.0);
        })?;
        let mut runner = sliding.runner();
        runner.set_out_of_balance(out_of_balance_kg_m);
        let samples = (LEARNT_AT_REST_S / self.parts.sample_period_s).ceil() as usize;
        (0..samples).for_each(|_| {
            runner.step_array(&[0.0; READINGS]);
        });
        sliding.differentiate(&runner.states(), &sliding.learning_states())
    }

    /// Returns the derivative of a step about a state, by the states in `dynamic` and by the readings.
    fn differentiate(&self, about: &[f64], dynamic: &[usize]) -> Result<StateSpace, Error> {
        let programs = &self.programs;
        let states = programs.state_count();
        let variables = dynamic.len() + READINGS;
        let variable = |value: f64, i: usize| {
            let mut slope = vec![0.0; variables];
            slope[i] = 1.0;
            Dual { value, slope }
        };
        let step = Compiled::<Dual>::new(&programs.step, states);
        let mut memory = vec![Dual::from_f64(0.0); step.memory()];
        for (place, value) in memory.iter_mut().zip(about) {
            *place = Dual::from_f64(*value);
        }
        for (i, &state) in dynamic.iter().enumerate() {
            memory[state] = variable(about[state], i);
        }
        let readings: Vec<Dual> = (0..READINGS).map(|j| variable(0.0, dynamic.len() + j)).collect();
        let output = step.run(&mut memory, &readings).unwrap_or(Dual::from_f64(0.0));
        let rows: Vec<&Dual> = dynamic.iter().map(|&state| &memory[state]).collect();
        self.assemble(&rows, &output)
    }

    fn assemble(&self, next: &[&Dual], output: &Dual) -> Result<StateSpace, Error> {
        let n = next.len();
        let at = |row: &Dual, j: usize| row.slope.get(j).copied().unwrap_or(0.0);
        let A = Mat::from_fn(n, n, |i, j| at(next[i], j));
        let B = Mat::from_fn(n, COMMON_READINGS, |i, j| at(next[i], n + j));
        let C = Mat::from_fn(1, n, |_, j| at(output, j));
        let D = Mat::from_fn(1, COMMON_READINGS, |_, j| at(output, n + j));
        let timebase = Timebase::Discrete { period_s: self.parts.sample_period_s };
        Ok(StateSpace::new(A, B, C, D, timebase)?)
    }

    /// Returns the states that carry signals: those of the prefilter and the paths, and the control of the sample before.
    fn dynamic_states(&self) -> Vec<usize> {
        let carries = |name: &str| {
            name == lower::PREFILTER_STATES
                || name == lower::PREVIOUS_CONTROL
                || self.parts.paths.iter().any(|path| path.name == name)
        };
        let groups = self.programs.states.iter().filter(|group| carries(&group.name));
        groups.flat_map(|group| group.first..group.first + group.initial.len()).collect()
    }

    /// Returns the states that carry signals or what is learnt; those that only weigh what a sample tells are left out.
    fn learning_states(&self) -> Vec<usize> {
        let weighs =
            |name: &str| name == "liveliness" || name.starts_with("variance_") || name.starts_with("factor_");
        let groups = self.programs.states.iter().filter(|group| !weighs(&group.name));
        groups.flat_map(|group| group.first..group.first + group.initial.len()).collect()
    }
}

/// Keeps a projection at the elevation of its design.
fn stand_at_design(parts: &mut Parts) {
    parts.projection.iter_mut().for_each(|projection| projection.angle_reading = None);
}
