//! What a design shows without a verification: the figures of its loop and of its step, and a few points of its sensitivity.

use counterpoise_verify::measure::{history_figures, loop_figures};
use counterpoise_verify::{LoopFigure, MeasuredFigure, Model, PerformanceFigure, StepFigure};

use crate::preview::DesignPreview;
use crate::tolerance::SMALLEST_MODULUS;

/// The sensitivity at a few frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct SensitivityPoints {
    /// First and last frequency, Hz.
    pub ends_hz: [f64; 2],
    /// Modulus at equal ratios of frequency between them, dB; empty if the design has no responses.
    pub modulus_db: Vec<f64>,
}

impl DesignPreview {
    /// Returns the figures of the loop. The radius of its poles is not computed: 0 stands for a stable loop, infinity for an unstable one.
    pub fn loop_figures(&self) -> Vec<MeasuredFigure> {
        let pole_radius = if self.margins.closed_loop_stable { 0.0 } else { f64::INFINITY };
        loop_figures(&self.margins, pole_radius)
    }

    /// Returns the figures that need no verification: those of the loop but its poles, and those of the step that do not depend on how long
    /// it is watched.
    pub fn live_figures(&self) -> Vec<MeasuredFigure> {
        let mut figures = self.loop_figures();
        figures.extend(history_figures(&self.step, 0.0));
        figures.retain(|measured| is_live(measured.figure));
        figures
    }

    /// Returns so many points of the sensitivity at equal ratios of frequency, two at least.
    pub fn sensitivity_points(&self, count: usize) -> SensitivityPoints {
        let frequencies = &self.curves.frequency_hz;
        let response = self.curves.sensitivities.first().map(|curve| &curve.response);
        let (Some(first), Some(last), Some(response)) = (frequencies.first(), frequencies.last(), response)
        else {
            return SensitivityPoints { ends_hz: [1.0, 1.0], modulus_db: Vec::new() };
        };
        let point = |k: usize| {
            let wanted = first * (last / first).powf(k as f64 / (count - 1) as f64);
            let at = frequencies.partition_point(|hz| *hz < wanted).min(response.len().saturating_sub(1));
            20.0 * response[at].norm().max(SMALLEST_MODULUS).log10()
        };
        SensitivityPoints { ends_hz: [*first, *last], modulus_db: (0..count).map(point).collect() }
    }
}

/// Returns whether a figure is known without a verification.
fn is_live(figure: PerformanceFigure) -> bool {
    match figure {
        PerformanceFigure::Loop(figure) => figure != LoopFigure::PoleRadius,
        PerformanceFigure::Step(Model::Linear, figure) => matches!(
            figure,
            StepFigure::Overshoot | StepFigure::RiseTime | StepFigure::PeakTime | StepFigure::ControlPeak
        ),
        _ => false,
    }
}
