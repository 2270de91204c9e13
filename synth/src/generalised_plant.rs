//! The generalised plant of the textbooks, and what can be wrong with one.

use counterpoise_linalg::{Mat, Svd, svd};
use counterpoise_lti::scaling::balance;
use counterpoise_lti::{NamedSystem, StateSpace, Timebase, connect, lft};

use crate::Error;
use crate::cause::ModeBlock;
use crate::cause::{Cause, PlantCause};
use crate::finding::{DesignFinding, Part};
use crate::tolerance::{FULL_RANK, SAME_SHARE};

/// A plant between what disturbs and what is judged
///
/// ```text
///     w ---> |       | ---> z         x' = A  x + B1  w + B2  u
///            |   P   |                z  = C1 x + D11 w + D12 u
///     u ---> |       | ---> y         y  = C2 x + D21 w + D22 u
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralisedPlant {
    /// From (w, u) to (z, y), continuous.
    pub system: StateSpace,
    /// Number of controls u, the last inputs.
    pub controls: usize,
    /// Number of measurements y, the last outputs.
    pub measurements: usize,
    /// The blocks whose states these are, in order; may be empty.
    pub origins: Vec<StateOrigin>,
}

/// A block that some successive states of a generalised plant belong to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StateOrigin {
    /// Name of the block.
    pub block: String,
    /// Number of states.
    pub states: usize,
}

impl StateOrigin {
    /// Returns a named block with its number of states.
    pub fn new(block: impl Into<String>, states: usize) -> Self {
        Self { block: block.into(), states }
    }
}

/// A system with named signals that has a name itself, by which refusals speak of it.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedBlock<'a> {
    /// Name of the block.
    pub name: &'a str,
    /// The system and the names of its inputs and outputs.
    pub system: NamedSystem,
}

/// Named inputs or outputs of a generalised plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ports<'a> {
    /// Their names, in order.
    pub names: &'a [&'a str],
    /// Number of states, the last ones, that belong to the controller.
    pub of_controller: usize,
}

/// The blocks of a generalised plant, states scaled by powers of two.
pub(crate) struct Blocks {
    pub A: Mat,
    pub B1: Mat,
    pub B2: Mat,
    pub C1: Mat,
    pub C2: Mat,
    pub D11: Mat,
    pub D12: Mat,
    pub D21: Mat,
    pub D22: Mat,
    /// Physical state = scale x scaled state, powers of two.
    pub scale: Vec<f64>,
    /// Origins of the states, as [`GeneralisedPlant::origins`].
    pub origins: Vec<StateOrigin>,
}

impl Blocks {
    /// Returns the block with most of a direction, of which the moduli are given, an entry a state; without names the
    /// state with most of it.
    pub fn block_of(&self, moduli: &[f64]) -> ModeBlock {
        let mut shares: Vec<(f64, ModeBlock)> = Vec::new();
        let mut from = 0;
        for origin in &self.origins {
            let share: f64 = moduli.iter().skip(from).take(origin.states).map(|x| x * x).sum();
            shares.push((share, ModeBlock::Named(origin.block.clone())));
            from += origin.states;
        }
        let unnamed = moduli.iter().enumerate().skip(from);
        shares.extend(unnamed.map(|(k, x)| (x * x, ModeBlock::State(k + 1))));
        // Of equal shares, a block that is there twice say, the first.
        let largest = shares.iter().map(|share| share.0).fold(0.0, f64::max);
        let most = shares.into_iter().find(|share| share.0 >= largest * (1.0 - SAME_SHARE));
        most.map_or(ModeBlock::Plant, |share| share.1)
    }

    /// Returns a controller whose states estimate the scaled states, with states that estimate the plant's own: exact.
    pub fn convert_to_plant_states(&self, K: StateSpace) -> StateSpace {
        let T = &self.scale;
        let A = Mat::from_fn(K.order(), K.order(), |i, j| K.A[(i, j)] * (T[i] / T[j]));
        let B = Mat::from_fn(K.order(), K.inputs(), |i, j| K.B[(i, j)] * T[i]);
        let C = Mat::from_fn(K.outputs(), K.order(), |i, j| K.C[(i, j)] / T[j]);
        StateSpace { A, B, C, ..K }
    }
}

impl GeneralisedPlant {
    /// Returns the generalised plant with its last `controls` inputs and `measurements` outputs.
    ///
    /// # Errors
    /// [`Error::System`] for a sampled system or one with an entry that is not finite, [`Error::Index`] if it has fewer inputs or outputs.
    pub fn new(system: StateSpace, controls: usize, measurements: usize) -> Result<Self, Error> {
        if system.timebase != Timebase::Continuous {
            return Err(Error::System { what: "generalised plant", problem: "it must be continuous" });
        }
        if ![&system.A, &system.B, &system.C, &system.D].iter().all(|matrix| matrix.is_finite()) {
            return Err(Error::System { what: "generalised plant", problem: "every entry must be finite" });
        }
        let within = |what, index, count| {
            if index <= count { Ok(()) } else { Err(Error::Index { what, index, count }) }
        };
        within("control", controls, system.inputs())?;
        within("measurement", measurements, system.outputs())?;
        Ok(Self { system, controls, measurements, origins: Vec::new() })
    }

    /// Returns the plant with the blocks named that the states belong to, in order: refusals name them.
    ///
    /// # Errors
    /// [`Error::Index`] if the blocks have more states than the plant.
    pub fn of_blocks(self, origins: Vec<StateOrigin>) -> Result<Self, Error> {
        let (index, count) = (origins.iter().map(|origin| origin.states).sum(), self.system.order());
        if index > count {
            return Err(Error::Index { what: "last state of the named blocks", index, count });
        }
        Ok(Self { origins, ..self })
    }

    /// Returns the plant of named blocks wired by name ([`counterpoise_lti::connect`](fn@counterpoise_lti::connect)): the ports of `inputs` that belong
    /// to the controller are the controls, those of `outputs` the measurements. Refusals name the blocks.
    ///
    /// # Errors
    /// As [`counterpoise_lti::connect`](fn@counterpoise_lti::connect) and [`GeneralisedPlant::new`].
    pub fn connect_by_name(
        blocks: &[NamedBlock<'_>],
        inputs: Ports<'_>,
        outputs: Ports<'_>,
    ) -> Result<Self, Error> {
        let systems: Vec<NamedSystem> = blocks.iter().map(|block| block.system.clone()).collect();
        let origin = |block: &NamedBlock<'_>| StateOrigin::new(block.name, block.system.system.order());
        let connected = connect(&systems, inputs.names, outputs.names)?;
        Self::new(connected, inputs.of_controller, outputs.of_controller)?
            .of_blocks(blocks.iter().map(origin).collect())
    }

    /// Returns the closed loop from w to z with the controller u = K y.
    ///
    /// # Errors
    /// [`Error::Lti`] if K does not fit, or the algebraic loop is singular.
    pub fn close(&self, K: &StateSpace) -> Result<StateSpace, Error> {
        Ok(lft(&self.system, K)?)
    }

    pub(crate) fn blocks(&self) -> Blocks {
        let (system, scale) = balance(&self.system);
        let n = system.order();
        let (w, z) = (system.inputs() - self.controls, system.outputs() - self.measurements);
        let (u, y) = (self.controls, self.measurements);
        Blocks {
            B1: system.B.block(0, 0, n, w),
            B2: system.B.block(0, w, n, u),
            C1: system.C.block(0, 0, z, n),
            C2: system.C.block(z, 0, y, n),
            D11: system.D.block(0, 0, z, w),
            D12: system.D.block(0, w, z, u),
            D21: system.D.block(z, 0, y, w),
            D22: system.D.block(z, w, y, u),
            A: system.A,
            scale,
            origins: self.origins.clone(),
        }
    }

    /// D12 must have full column rank, D21 full row rank: every control is weighed, every measurement is noisy.
    pub(crate) fn check_regular(&self) -> Result<(), Error> {
        let blocks = self.blocks();
        let mut findings = Vec::new();
        let mut refuse =
            |cause| findings.push(DesignFinding::refusal(Part::Generalised, cause).at(f64::INFINITY));
        if let Some(column) = lost_column(&blocks.D12)? {
            refuse(Cause::Plant(PlantCause::ControlUnweighed { control: column + 1 }));
        }
        if let Some(row) = lost_column(&blocks.D21.t())? {
            refuse(Cause::Plant(PlantCause::MeasurementNoiseless { measurement: row + 1 }));
        }
        if findings.is_empty() { Ok(()) } else { Err(Error::refusal(findings)) }
    }
}

/// Of a matrix without full column rank the column with most of what it sends to zero.
fn lost_column(matrix: &Mat) -> Result<Option<usize>, Error> {
    let columns = matrix.ncols();
    if columns == 0 {
        return Ok(None);
    }
    // Rows of zeros, so that every right singular vector is there.
    let tall = matrix.vstack(&Mat::zeros(columns, columns));
    let Svd { s, V, .. } = svd(&tall)?;
    if s[columns - 1] > FULL_RANK * s[0] {
        return Ok(None);
    }
    let size = |j: &usize| V[(*j, columns - 1)].abs();
    Ok((0..columns).max_by(|i, j| size(i).total_cmp(&size(j))))
}

/// K0 designed for D22 = 0, put around a plant with D22: K0 inv(I + D22 K0).
pub(crate) fn absorb_direct_path(K: StateSpace, D22: &Mat) -> Result<StateSpace, Error> {
    if D22.norm_max() == 0.0 {
        return Ok(K);
    }
    let direct = StateSpace::gain(D22.clone(), Timebase::Continuous)?;
    let closed = counterpoise_lti::feedback(&K, &direct)?;
    Ok(closed)
}
