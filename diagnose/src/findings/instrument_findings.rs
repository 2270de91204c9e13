//! Faults of instruments as findings.

use crate::findings::answer::{Finding, FindingBasis, FittedParameter, Name};
use crate::library::{Component, EffectName};
use crate::recording::instrument_faults::{FaultKind, InstrumentFault, RecorderColumn};
use crate::tolerance::RIGHT_WHERE_EXPLAINED;

/// Returns the component that is at fault if a column is wrong.
pub fn component_of(column: RecorderColumn) -> Component {
    match column {
        RecorderColumn::Demand => Component::Demand,
        RecorderColumn::Control => Component::Control,
        RecorderColumn::HubRate => Component::HubGyro,
        RecorderColumn::PlatformRate => Component::PlatformGyro,
        RecorderColumn::PlatformAccel => Component::PlatformAccelerometer,
        RecorderColumn::MotorRate => Component::MotorTachometer,
        RecorderColumn::HubPosition => Component::HubResolver,
    }
}

/// Returns the name of the effect of a kind of fault.
pub fn effect_of(kind: &FaultKind) -> EffectName {
    match kind {
        FaultKind::Scale { .. } => EffectName::Scale,
        FaultKind::ClockOffset { .. } => EffectName::ClockOffset,
        FaultKind::ClockDrift { .. } => EffectName::ClockDrift,
        FaultKind::Bias { .. } => EffectName::Bias,
        FaultKind::Stuck { .. } => EffectName::Stuck,
        FaultKind::Clipped { .. } => EffectName::Clipped,
        FaultKind::Coarse { .. } => EffectName::Quantisation,
        FaultKind::Held { .. } => EffectName::SampleRate,
        FaultKind::Exchanged { .. } => EffectName::Exchanged,
    }
}

/// Returns a fault as a finding of a diagnosis.
pub fn make_finding(fault: &InstrumentFault) -> Finding {
    let effect = effect_of(&fault.kind);
    let other = |column: &RecorderColumn| Name { effect, component: component_of(*column) };
    let exchanged = match fault.kind {
        FaultKind::Exchanged { with } => vec![other(&with)],
        _ => Vec::new(),
    };
    Finding {
        effect,
        component: component_of(fault.column),
        probability: RIGHT_WHERE_EXPLAINED / (1.0 + fault.or.len() as f64),
        basis: FindingBasis::InstrumentFault(fault.clone()),
        parameters: parameters_of(&fault.kind),
        alternatives: fault.or.iter().map(other).chain(exchanged).collect(),
    }
}

fn parameters_of(kind: &FaultKind) -> Vec<FittedParameter> {
    let one = |name, value: f64, unit, before, half_width: f64| {
        vec![FittedParameter { name, value, unit, before, ci95: [value - half_width, value + half_width] }]
    };
    match *kind {
        FaultKind::Scale { gain, doubt } => one("gain", gain, "1", 1.0, (gain * doubt).abs()),
        FaultKind::ClockOffset { late_s, doubt_s } => one("offset", late_s, "s", 0.0, doubt_s),
        FaultKind::ClockDrift { slow, doubt } => one("drift", slow, "1", 0.0, doubt),
        FaultKind::Bias { bias, doubt } => one("bias", bias, "", 0.0, doubt),
        FaultKind::Stuck { from_s, .. } => one("from", from_s, "s", 0.0, 0.0),
        FaultKind::Clipped { limit, .. } => one("limit", limit, "", 0.0, 0.0),
        FaultKind::Coarse { step, expected } => one("step", step, "", expected, 0.0),
        FaultKind::Held { samples } => one("samples", samples as f64, "1", 1.0, 0.0),
        FaultKind::Exchanged { .. } => Vec::new(),
    }
}
