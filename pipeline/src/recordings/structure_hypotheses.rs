//! The parts that the model of a structure may lack, and the result of trying each.

/// One thing that the model may lack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// Nothing: the model as it is.
    Nothing,
    /// More elements.
    Mesh,
    /// Shear and rotary inertia.
    Shear,
    /// A mass at an end of the beam.
    EndMass(End),
}

/// An end of the beam.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The end where the sections begin.
    Near,
    /// The tip.
    Tip,
}

/// A hypothesis: a change, with or without another stiffness of the whole beam.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hypothesis {
    /// The change.
    pub change: Change,
    /// The treatment of the stiffness.
    pub scaled: Scale,
}

/// The treatment of the stiffness of the whole beam.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// The stiffness is that of the project.
    AsItIs,
    /// A factor on the stiffness is fitted.
    Fitted,
}

/// A hypothesis that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct TriedStructure {
    /// The hypothesis.
    pub hypothesis: Hypothesis,
    /// Fitted numbers.
    pub parameters: Vec<FittedStructureValue>,
    /// RMS relative error of all modes, %.
    pub rms_percent: f64,
    /// RMS relative error of modes that were left out of the fit, one after the other, %.
    pub left_out_percent: f64,
    /// Frequencies of the fitted model, Hz.
    pub modes_hz: Vec<f64>,
    /// By how much each of them is off, percent of the measured one.
    pub errors_percent: Vec<f64>,
}

/// A number that was fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedStructureValue {
    /// What it is.
    pub parameter: FittedParameter,
    /// Its value.
    pub value: f64,
}

/// What can be fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FittedParameter {
    /// The mass at an end of the beam, kg.
    Mass,
    /// The factor on the stiffness of the whole beam.
    StiffnessFactor,
}
