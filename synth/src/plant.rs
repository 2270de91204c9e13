//! The plant as a design sees it: a linear system, its sensors, and the delay of the loop.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase, append, delay::pade, series};

use crate::tolerance::ROUNDED_SAMPLE;
use crate::{DisturbanceChannel, Error};

/// Plant of a design
///
/// ```text
///                    heave   pitch, its derivatives
///                      |       |
///                    +-v-------v-+                  +------------+
///  control --[delay]-->  system  +-- rate ----------> hub sensor +--> measured rate
///                    +-----------+-- other outputs  +------------+
///  heave ---[ heave sensor ]---> measured heave       pitch ---[ pitch sensor ]---> measured pitch
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DesignPlant {
    /// The linear plant, continuous, without direct path from the control to the rate.
    pub system: StateSpace,
    /// Input that is the control.
    pub control: usize,
    /// Inputs on which heave acts: heave itself, then its derivatives in order.
    pub heave: Vec<usize>,
    /// Inputs on which pitch acts: the pitch rate, then its derivatives in order.
    pub pitch: Vec<usize>,
    /// Output that is the measured and controlled rate.
    pub rate: usize,
    /// Measured rate over true rate, one input and one output; `None` if the sensor is perfect.
    pub hub_sensor: Option<StateSpace>,
    /// The sensor that a sampled loop takes in place of that one if its readings are late: an approximation of a delay is not exact where a resonance
    /// turns the phase fast. `None` if they are not late.
    pub late_reading: Option<LateReading>,
    /// Measured heave over true heave.
    pub heave_sensor: Option<StateSpace>,
    /// Measured pitch over true pitch.
    pub pitch_sensor: Option<StateSpace>,
    /// Delay between measurement and action, s.
    pub delay_s: f64,
    /// Order of the Pade approximation of the delay; 0 leaves the delay out.
    pub pade_order: usize,
    /// The inner loop of a cascade, if `rate` is a position and the loop is to be one.
    pub rate_loop: Option<Box<RateLoop>>,
}

/// A sensor whose readings are late.
#[derive(Debug, Clone, PartialEq)]
pub struct LateReading {
    /// Measured over true quantity, with what is left of the delay beyond whole samples.
    pub dynamics: StateSpace,
    /// Whole samples of the delay, s.
    pub delay_s: f64,
}

impl LateReading {
    /// Returns the delay in samples of a period, rounded up.
    pub fn samples(&self, period_s: f64) -> usize {
        (self.delay_s / period_s - ROUNDED_SAMPLE).ceil().max(0.0) as usize
    }
}

/// The inner loop of a cascade: the rate whose integral the sensor measures.
#[derive(Debug, Clone, PartialEq)]
pub struct RateLoop {
    /// The plant with that rate as its `rate` output; its hub sensor holds the lag of the difference quotient.
    pub plant: DesignPlant,
    /// The period over which two readings are differenced, s: the sample period.
    pub period_s: f64,
}

impl DesignPlant {
    /// Returns the plant with perfect sensors and no delay.
    pub fn ideal(system: StateSpace, control: usize, rate: usize) -> Self {
        Self {
            system,
            control,
            heave: Vec::new(),
            pitch: Vec::new(),
            rate,
            hub_sensor: None,
            late_reading: None,
            heave_sensor: None,
            pitch_sensor: None,
            delay_s: 0.0,
            pade_order: 0,
            rate_loop: None,
        }
    }

    /// Returns the plant that the weights are for: that of the inner loop if there is one.
    pub fn weighted_plant(&self) -> &Self {
        self.rate_loop.as_ref().map_or(self, |inner| &inner.plant)
    }

    /// Checks that indices name signals, that everything is continuous, and that sensors have one input and one output.
    ///
    /// # Errors
    /// [`Error::Index`], [`Error::System`], [`Error::Range`].
    pub fn check(&self) -> Result<(), Error> {
        self.check_indices()?;
        if self.system.timebase != Timebase::Continuous {
            return Err(Error::System { what: "plant", problem: "it must be continuous" });
        }
        for sensor in [&self.hub_sensor, &self.heave_sensor, &self.pitch_sensor].into_iter().flatten() {
            check_sensor(sensor)?;
        }
        if !(self.delay_s >= 0.0 && self.delay_s.is_finite()) {
            return Err(Error::Range {
                what: "delay in s",
                value: self.delay_s,
                allowed: "zero or positive",
            });
        }
        Ok(())
    }

    fn check_indices(&self) -> Result<(), Error> {
        let inputs = self.system.inputs();
        let index = |what, index, count| {
            if index < count { Ok(()) } else { Err(Error::Index { what, index, count }) }
        };
        index("control input", self.control, inputs)?;
        self.heave.iter().try_for_each(|&i| index("heave input", i, inputs))?;
        self.pitch.iter().try_for_each(|&i| index("pitch input", i, inputs))?;
        index("rate output", self.rate, self.system.outputs())
    }

    /// Returns the inputs of a disturbance channel.
    pub fn columns(&self, channel: DisturbanceChannel) -> &[usize] {
        match channel {
            DisturbanceChannel::Heave => &self.heave,
            DisturbanceChannel::Pitch => &self.pitch,
        }
    }

    /// Returns the sensor of a disturbance channel.
    pub fn sensor(&self, channel: DisturbanceChannel) -> Option<&StateSpace> {
        match channel {
            DisturbanceChannel::Heave => self.heave_sensor.as_ref(),
            DisturbanceChannel::Pitch => self.pitch_sensor.as_ref(),
        }
    }

    /// Returns the plant behind the delay: the control is delayed, the other inputs are not. Inputs and outputs keep their
    /// numbers; the states are \[delay; plant\].
    ///
    /// # Errors
    /// [`Error::Lti`], and those of [`DesignPlant::check`].
    pub fn delayed_plant(&self) -> Result<StateSpace, Error> {
        self.check()?;
        if self.delay_s == 0.0 || self.pade_order == 0 {
            return Ok(self.system.clone());
        }
        let inputs = self.system.inputs();
        let others: Vec<usize> = (0..inputs).filter(|&i| i != self.control).collect();
        let order: Vec<usize> = std::iter::once(self.control).chain(others).collect();
        let outputs: Vec<usize> = (0..self.system.outputs()).collect();
        let wires = StateSpace::gain(Mat::eye(inputs - 1), Timebase::Continuous)?;
        let front = append(&pade(self.delay_s, self.pade_order)?, &wires)?;
        let delayed = series(&front, &self.system.select(&outputs, &order))?;
        let back: Vec<usize> = (0..inputs).map(|i| order.iter().position(|&o| o == i).unwrap_or(i)).collect();
        Ok(delayed.select(&outputs, &back))
    }

    /// Returns what the feedback sees: outputs \[measured rate; every true output\], inputs as the plant's; the states are
    /// \[delay; plant; sensor\].
    ///
    /// # Errors
    /// As [`DesignPlant::delayed_plant`].
    pub fn measured_plant(&self) -> Result<StateSpace, Error> {
        let plant = self.delayed_plant()?;
        let all = 0..plant.outputs();
        let doubled: Vec<usize> = std::iter::once(self.rate).chain(all).collect();
        let inputs: Vec<usize> = (0..plant.inputs()).collect();
        let doubled = plant.select(&doubled, &inputs);
        let Some(sensor) = &self.hub_sensor else { return Ok(doubled) };
        let wires = StateSpace::gain(Mat::eye(plant.outputs()), Timebase::Continuous)?;
        Ok(series(&doubled, &append(sensor, &wires)?)?)
    }
}

fn check_sensor(sensor: &StateSpace) -> Result<(), Error> {
    if sensor.timebase != Timebase::Continuous {
        return Err(Error::System { what: "sensor", problem: "it must be continuous" });
    }
    if (sensor.inputs(), sensor.outputs()) != (1, 1) {
        return Err(Error::System { what: "sensor", problem: "it must have one input and one output" });
    }
    Ok(())
}
