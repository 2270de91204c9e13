//! The rate that an expected disturbance leaves under a design.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase, append, h2norm, lft, series};

use crate::feedforward::with_derivatives;
use crate::{Assembly, Design, DesignPlant, DisturbanceChannel, Error};

/// Returns the RMS of the true rate under a channel's generator, feedback and feedforward in action, the feedforward's output
/// times `gain`; infinite for a loop that is not stable.
///
/// # Errors
/// [`Error::System`] if the design has no feedforward for the channel.
pub fn stabilisation_error(
    plant: &DesignPlant,
    design: &Design,
    channel: DisturbanceChannel,
    gain: f64,
) -> Result<f64, Error> {
    error_at(plant, design, channel, ResidualChoice { gain, output: plant.rate })
}

/// Choice of a residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResidualChoice {
    /// Factor on the feedforward's output: 0 leaves the feedback alone.
    pub gain: f64,
    /// The plant's output whose RMS is wanted.
    pub output: usize,
}

/// Returns the same as [`stabilisation_error`] at any output of the plant: the tip's rate, for instance.
///
/// # Errors
/// As [`stabilisation_error`], and [`Error::Index`] for an output that is none.
pub fn error_at(
    plant: &DesignPlant,
    design: &Design,
    channel: DisturbanceChannel,
    ResidualChoice { gain, output }: ResidualChoice,
) -> Result<f64, Error> {
    let count = plant.system.outputs();
    if output >= count {
        return Err(Error::Index { what: "output", index: output, count });
    }
    let missing = Error::System { what: "design", problem: "it has no feedforward for this channel" };
    let (Some(part), Some(weights)) = (design.part(channel), design.specification.feedforward(channel))
    else {
        return Err(missing);
    };
    let (columns, read) = (plant.columns(channel), part.module.inputs());
    let source = with_derivatives(&weights.generator.realise()?, columns.len())?;
    let module = design.as_seen(&part.module)?.scale_io(&[gain, gain], &vec![1.0; read])?;
    let module = match plant.sensor(channel) {
        Some(sensor) if read == 1 => series(sensor, &module)?,
        _ => module,
    };
    let wires = |n: usize| StateSpace::gain(Mat::eye(n), Timebase::Continuous);
    let doubled = StateSpace::gain(spread(columns.len(), read), Timebase::Continuous)?;
    let driven = series(&series(&source, &doubled)?, &append(&wires(columns.len())?, &module)?)?;
    let seen = plant.measured_plant()?;
    let inputs: Vec<usize> = columns.iter().copied().chain([plant.control]).collect();
    let open = append(&driven, &wires(1)?)?;
    let sum = StateSpace::gain(addition(columns.len()), Timebase::Continuous)?;
    let moved = append(&seen.select(&[1 + output, 0], &inputs), &wires(1)?)?;
    let expected = match design.specification.assembly {
        Assembly::SimpleAdd | Assembly::Joint => 0.0,
        Assembly::Grimble => -1.0,
    };
    let told = Mat::from_rows(&[&[1.0, 0.0, 0.0], &[0.0, 1.0, expected]]);
    let P = series(&series(&open, &sum)?, &series(&moved, &StateSpace::gain(told, Timebase::Continuous)?)?)?;
    let K = design.feedback_controller().select(&[0], &[1]);
    Ok(h2norm(&lft(&P, &K)?)?)
}

/// From (d, d', ...) to (d, d', ..., what the module reads).
fn spread(signals: usize, read: usize) -> Mat {
    Mat::eye(signals).vstack(&Mat::from_fn(read, signals, |i, j| if i == j { 1.0 } else { 0.0 }))
}

/// From (d, d', ..., u of the feedforward, rate that it expects, u of the feedback) to (d, d', ..., sum of the u, rate that
/// is expected).
fn addition(signals: usize) -> Mat {
    let mut D = Mat::zeros(signals + 2, signals + 3);
    D.set_block(0, 0, &Mat::eye(signals));
    (D[(signals, signals)], D[(signals, signals + 2)], D[(signals + 1, signals + 1)]) = (1.0, 1.0, 1.0);
    D
}
