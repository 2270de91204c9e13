//! The search against a closed-form machine: every channel is a formula of the parameters, so the truth is known and
//! nothing depends on the simulator.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_diagnose::findings::answer::{Answer, DiagnosisVerdict};
use counterpoise_diagnose::findings::verdict::VerdictEvidence;
use counterpoise_diagnose::library::{Component, EffectName, list_effects};
use counterpoise_diagnose::selection::searcher::Searcher;
use counterpoise_diagnose::selection::sizes::Sizes;
use counterpoise_diagnose::simulator_access::{
    Assessment, ChannelResidual, ControlSource, SimulatorAccess, Span,
};
use counterpoise_models::{Parameters, reference};
use counterpoise_pool::Serial;
use counterpoise_recordings::Channel;

const SAMPLES: usize = 1500;
const FLOOR: f64 = 0.01;

/// A machine whose control follows from its motion by statics, and whose hub rate by nothing but the demand.
struct Statics {
    truth: Parameters,
    /// A torque that no effect of the library makes.
    strange: f64,
}

fn motion(index: usize, k: usize) -> (f64, f64, f64) {
    let t = k as f64 * 0.01;
    let w = [0.1 * (1.3 * t).sin(), 0.06 * (2.9 * t).sin() + 0.05 * (0.7 * t).cos()][index % 2];
    let angle = [
        0.1 * (1.0 - (1.3 * t).cos()) / 1.3,
        0.06 * (1.0 - (2.9 * t).cos()) / 2.9 + 0.05 * (0.7 * t).sin() / 0.7,
    ];
    (t, w, angle[index % 2])
}

fn control(p: &Parameters, index: usize, k: usize) -> f64 {
    let (_, w, angle) = motion(index, k);
    let f = &p.pivot_friction;
    let level =
        f.coulomb_nm() * (1.0 + (f.static_ratio - 1.0) * (-(w / f.stribeck_rate_rad_s).powi(2)).exp());
    let dry = level * (1.0 + f.asymmetry * w.signum()) * (w / 1e-4).tanh();
    let moment = p.lumped.as_ref().unwrap().out_of_balance_kg_m * p.gravity_m_s2 * angle.cos();
    let ratio = p.gearbox.ratio;
    let cogging = ratio * p.motor.cogging.at(ratio * angle);
    (moment + dry + f.viscous_nm_s_rad * w + f.quadratic_nm_s2_rad2 * w * w.abs() - cogging)
        / (ratio * 3.0 * p.motor.torque_constant_nm_a)
}

fn noise(index: usize, k: usize) -> f64 {
    let mut seed = (index as u64 * 7919 + k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    seed ^= seed >> 31;
    let uniform = |s: u64| (s.wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40) as f64 / (1u64 << 24) as f64 - 0.5;
    3.46 * uniform(seed)
}

impl SimulatorAccess for Statics {
    fn count(&self) -> usize {
        4
    }

    fn most_active_recording(&self) -> usize {
        0
    }

    fn residuals(
        &self,
        parameters: &Parameters,
        index: usize,
        span: Span,
        _: &Assessment,
    ) -> Option<Vec<ChannelResidual>> {
        let strange = |k: usize| self.strange * (23.0 * motion(index, k).0).sin();
        let samples = if span == Span::Whole { SAMPLES } else { SAMPLES * 6 / 10 };
        let at = |k: usize| {
            let difference = control(parameters, index, k) - control(&self.truth, index, k) - strange(k);
            difference / FLOOR + noise(index, k)
        };
        let residual = (0..samples).map(at).collect();
        Some(vec![ChannelResidual { channel: Channel::Control, residual, floor: FLOOR }])
    }

    fn assess_from(&self, parameters: &Parameters, index: usize, _: &Assessment) -> Option<Assessment> {
        self.assess(parameters, index)
    }

    fn assess(&self, parameters: &Parameters, index: usize) -> Option<Assessment> {
        let nothing = Assessment {
            channels: vec![],
            divergence: vec![0.0],
            start: None,
            source: ControlSource::ClosedLoop,
        };
        let channels = self.residuals(parameters, index, Span::Whole, &nothing)?;
        Some(Assessment { channels, ..nothing })
    }
}

fn diagnose_machine(change: impl Fn(&mut Parameters), strange: f64) -> Answer {
    let base = reference::rig();
    let mut truth = base.clone();
    change(&mut truth);
    let simulator = Statics { truth, strange };
    let search = Searcher {
        simulator: &simulator,
        pool: &Serial,
        base: &base,
        effects: list_effects(),
        seeds: vec![],
        sizes: Sizes::TYPICAL,
    }
    .search()
    .unwrap();
    let evidence = VerdictEvidence {
        simulator: &simulator,
        base: &base,
        search: &search,
        map: vec![],
        isolability: vec![],
        sizes: Sizes::TYPICAL,
        remarks: vec![],
    };
    evidence.answer()
}

#[test]
fn a_machine_as_modelled_is_consistent() {
    let answer = diagnose_machine(|_| (), 0.0);
    assert_eq!(answer.verdict, DiagnosisVerdict::Consistent, "{:?}", answer.findings);
    assert!(answer.findings.is_empty());
}

#[test]
fn stribeck_is_named_with_its_parameters() {
    let answer = diagnose_machine(
        |p| {
            p.pivot_friction.static_ratio = 1.55;
            p.pivot_friction.stribeck_rate_rad_s = 0.012;
        },
        0.0,
    );
    assert_eq!(answer.verdict, DiagnosisVerdict::Named, "{answer:?}");
    let finding = &answer.findings[0];
    assert_eq!((finding.component, finding.effect), (Component::Pivot, EffectName::Stribeck));
    assert!((finding.parameters[0].value - 1.55).abs() < 0.03, "{:?}", finding.parameters);
    assert!((finding.parameters[1].value / 0.012 - 1.0).abs() < 0.05, "{:?}", finding.parameters);
}

#[test]
fn two_effects_are_both_named() {
    let answer = diagnose_machine(
        |p| {
            p.lumped.as_mut().unwrap().out_of_balance_kg_m = 170.0;
            p.pivot_friction.viscous_nm_s_rad = 900.0;
        },
        0.0,
    );
    let mut names: Vec<_> = answer.findings.iter().map(|f| f.effect.name()).collect();
    names.sort_unstable();
    assert_eq!(names, ["out_of_balance", "viscous"], "{answer:?}");
}

#[test]
fn a_torque_that_no_effect_makes_gets_no_name() {
    let answer = diagnose_machine(|_| (), 0.3);
    assert_eq!(answer.verdict, DiagnosisVerdict::Unknown, "{:?}", answer.findings);
    assert_eq!(answer.findings[0].effect, EffectName::Unknown);
}
