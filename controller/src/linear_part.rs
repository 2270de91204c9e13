//! The linear part of a controller: its program, differentiated about a state of rest.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

use crate::compiled_program::CompiledProgram;
use crate::number::Dual;
use crate::signal::COMMON_READINGS;
use crate::tolerance::LEARNT_AT_REST_S;
use crate::{Controller, Error, Estimator, Learning, Number, Parts, READINGS, Runner, lowering};

impl Controller {
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

    /// Returns the linear part as [`Controller::linear`] does, with the estimator of the out-of-balance learning: gains and bias
    /// follow its estimate. The program is differentiated about the state that it reaches at rest, the sizes of what a sample
    /// tells held there, and the estimate outside its hold band. A mean over windows stands still between the ends of its windows, and is left so.
    ///
    /// # Errors
    /// As [`Controller::linear`].
    pub fn linear_learning(&self, out_of_balance_kg_m: f64) -> Result<StateSpace, Error> {
        let learns = |estimator: &Estimator| !matches!(estimator.learning, Learning::Mean { .. });
        if !self.parts().estimator.as_ref().is_some_and(learns) {
            return self.linear(out_of_balance_kg_m);
        }
        let sliding = self.with(|parts| {
            parts.observers.iter_mut().for_each(|observer| observer.volts_per_nm = 0.0);
            parts.drive_curve.clear();
            parts.transfer_time_s = 0.0;
            stand_at_design(parts);
            parts.estimator.iter_mut().for_each(learn_at_rest);
        })?;
        let mut runner = sliding.runner();
        runner.set_out_of_balance(out_of_balance_kg_m);
        let samples = (LEARNT_AT_REST_S / self.sample_period_s()).ceil() as usize;
        (0..samples).for_each(|_| {
            runner.step_array(&[0.0; READINGS]);
        });
        sliding.differentiate(&runner.states(), &sliding.learning_states())
    }

    /// Returns the derivative of a step about a state, by the states in `dynamic` and by the readings.
    fn differentiate(&self, about: &[f64], dynamic: &[usize]) -> Result<StateSpace, Error> {
        let programs = self.programs();
        let states = programs.state_count();
        let variables = dynamic.len() + READINGS;
        let variable = |value: f64, i: usize| {
            let mut slope = vec![0.0; variables];
            slope[i] = 1.0;
            Dual { value, slope }
        };
        let step = CompiledProgram::<Dual>::new(&programs.step, states);
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
        let timebase = Timebase::Discrete { period_s: self.sample_period_s() };
        Ok(StateSpace::new(A, B, C, D, timebase)?)
    }

    /// Returns the states that carry signals: those of the prefilter and the paths, and the control of the sample before.
    fn dynamic_states(&self) -> Vec<usize> {
        let carries = |name: &str| {
            name == lowering::PREFILTER_STATES
                || name == lowering::PREVIOUS_CONTROL
                || self.parts().paths.iter().any(|path| path.name == name)
        };
        let groups = self.programs().states.iter().filter(|group| carries(&group.name));
        groups.flat_map(|group| group.first..group.first + group.initial.len()).collect()
    }

    /// Returns the states that carry signals or what is learnt; those that only weigh what a sample tells are left out.
    fn learning_states(&self) -> Vec<usize> {
        let weighs =
            |name: &str| name == "liveliness" || name.starts_with("variance_") || name.starts_with("factor_");
        let groups = self.programs().states.iter();
        let groups =
            groups.filter(|group| !weighs(&group.name) && !lowering::is_of_friction_level(&group.name));
        groups.flat_map(|group| group.first..group.first + group.initial.len()).collect()
    }
}

/// Keeps a projection at the elevation of its design.
fn stand_at_design(parts: &mut Parts) {
    parts.projection.iter_mut().for_each(|projection| projection.angle_reading = None);
}

/// Takes the hold band from an estimator, and with gravity the dead-band on heave, so that it learns in a mechanism at rest: what is certified is the
/// loop that learns.
fn learn_at_rest(estimator: &mut Estimator) {
    estimator.hold_band_kg_m = 0.0;
    let has_gravity = estimator.gravity_m_s2 != 0.0;
    if let Learning::Squares { dead_band_m_s2, .. } = &mut estimator.learning
        && has_gravity
    {
        *dead_band_m_s2 = 0.0;
    }
}
