//! Machines of another size: the diagnosis works on a dynamically similar machine with torques and a gear ratio like the reference
//! rig's, and its answer is converted back.
//!
//! The library's bounds and typical sizes are those of a mechanism of some hundred kg m^2 behind a gear of some hundred turns.
//! Torques at the hub times S and the gear ratio times c leave every motion of the hub, every control and every current as
//! they are; torques at the motor are then S / c, its rates and angles c times what they were. A sensor of the torque that the transmission
//! passes reads S times as much, and what the loop demands is S times as much.

use crate::tolerance::findings::{UNSCALED_WITHIN, USUAL_INERTIA_AND_RATIO, USUAL_TORQUE_NM};
use counterpoise_models::friction::Similarity;
use counterpoise_models::loads::{Force, Loads};
use counterpoise_models::{
    Drift, FeedbackSignal, LearnedElement, LearnedPlace, Parameters, RegimeVariable, Ripple, Sensor,
};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::ReplayLoop;

use crate::findings::answer::{Answer, FindingBasis};
use crate::findings::channel_fits::PooledFits;
use crate::learning::reading::read_curve;
use crate::library::{Component, EffectName, EffectParameter, find_effects, list_textbook_effects};
use crate::localisation::error_hypotheses::Regime;
use crate::localisation::trend::Trend;
use crate::machine::SteadyDrive;
use crate::selection::sizes::Sizes;

/// Regime variables that are torques or the motor's angle: their values on the scaled machine are not the machine's own.
const SCALED_REGIMES: [Regime; 2] = [Regime::Load, Regime::MotorAngle];

/// Factors on the torques at the hub and on the gear ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimilarityScale {
    /// On torques at the hub.
    pub torque: f64,
    /// On the gear ratio.
    pub ratio: f64,
}

impl SimilarityScale {
    /// Returns the factors that bring a machine to the usual size; `None` if it has that size already, or no lumped structure.
    pub fn of(base: &Parameters, recordings: &[Recording]) -> Option<Self> {
        let lumped = base.lumped.as_ref()?;
        let by_inertia = USUAL_INERTIA_AND_RATIO.0 / lumped.inertia_kg_m2();
        // a free function over a turn of the motor keeps its turn only with its own gear
        let by_turn =
            |e: &LearnedElement| e.variable == RegimeVariable::Turn && e.place == LearnedPlace::Motor;
        // and a piston travels along its own lever
        let keeps_ratio = base.cylinder.is_some() || base.learned.iter().any(by_turn);
        let ratio = if keeps_ratio { 1.0 } else { USUAL_INERTIA_AND_RATIO.1 / base.gearbox.ratio };
        let near = |factor: f64, bound: f64| (1.0 / bound..=bound).contains(&factor);
        let usual = near(by_inertia, UNSCALED_WITHIN.0) && near(ratio, UNSCALED_WITHIN.1);
        let drive = drive_torque(base, recordings);
        let torque = if drive > 0.0 { USUAL_TORQUE_NM / drive } else { by_inertia };
        // powers of two, so that numbers are converted back to the last bit
        let near_power = |factor: f64| factor.log2().round().exp2();
        let scale = Self { torque: near_power(torque), ratio: near_power(ratio) };
        (!usual && torque.is_finite() && torque > 0.0).then_some(scale)
    }

    /// Returns the factors that undo these.
    pub fn inverse(self) -> Self {
        Self { torque: 1.0 / self.torque, ratio: 1.0 / self.ratio }
    }

    /// Returns what is known of the sizes of the scaled machine.
    pub fn sizes(self) -> Sizes {
        Sizes { typical: false, motor_turns: self.ratio, ..Sizes::TYPICAL }
    }

    /// Returns the dynamically similar machine with other torques and another gear.
    pub fn apply_to(self, base: &Parameters) -> Parameters {
        let (s, c) = (self.torque, self.ratio);
        let mut p = base.clone();
        if let Some(lumped) = &mut p.lumped {
            lumped.hub_inertia_kg_m2 *= s;
            lumped.beam_inertia_kg_m2 *= s;
            lumped.stiffness_nm_rad *= s;
            lumped.damping_nm_s_rad *= s;
            lumped.out_of_balance_kg_m *= s;
            lumped.vertical_offset_kg_m *= s;
            lumped.position_stiffness_nm_rad *= s;
            lumped.hysteresis_nm *= s;
            lumped.hysteresis_stiffness_nm_rad *= s;
            for link in &mut lumped.chain {
                link.inertia_kg_m2 *= s;
                link.stiffness_nm_rad *= s;
                link.damping_nm_s_rad *= s;
            }
        }
        p.gearbox.ratio *= c;
        p.gearbox.stiffness_nm_rad *= s;
        p.gearbox.damping_nm_s_rad *= s;
        p.gearbox.mesh_ripple = ripple(&p.gearbox.mesh_ripple, s, c);
        p.gearbox.kinematic_error = ripple(&p.gearbox.kinematic_error, 1.0, c);
        p.gearbox.hysteresis_nm *= s;
        p.gearbox.hysteresis_stiffness_nm_rad *= s;
        p.motor.inertia_kg_m2 *= s / (c * c);
        p.motor.torque_constant_nm_a *= s / c;
        p.motor.back_emf_v_s_rad /= c;
        p.motor.cogging = ripple(&p.motor.cogging, s / c, c);
        p.motor.torque_ripple = ripple(&p.motor.torque_ripple, 1.0, c);
        p.motor_friction = p.motor_friction.scale_similarly(Similarity { torque: s / c, angle: c });
        p.pivot_friction = p.pivot_friction.scale_similarly(Similarity { torque: s, angle: 1.0 });
        p.learned.iter_mut().for_each(|element| self.scale_element(element));
        set_loads(&mut p.loads, s);
        set_reading(&mut p.sensors.hub_gyro, self.reading(p.sensors.measured));
        if let Some(tachometer) = &mut p.sensors.motor_tachometer {
            set_reading(tachometer, c);
        }
        p
    }

    /// Returns the factor on what the loop's sensor reads: that of the torques if it measures one. A current, and a rate or an angle of the motor
    /// over the ratio, stay as they are.
    fn reading(self, measured: FeedbackSignal) -> f64 {
        if measured == FeedbackSignal::Torque { self.torque } else { 1.0 }
    }

    /// Scales a free function: its values if they are torques, and its points if they are torques, or angles or rates of the motor.
    fn scale_element(self, element: &mut LearnedElement) {
        let at_motor = element.place == LearnedPlace::Motor;
        let torque = if at_motor { self.torque / self.ratio } else { self.torque };
        let turns = if at_motor { self.ratio } else { 1.0 };
        if element.place.is_sensor() {
            let by = match element.place {
                LearnedPlace::LoopSensor => self.reading(element.measured),
                LearnedPlace::MotorTachometer => self.ratio,
                _ => 1.0,
            };
            let values = element.values.iter_mut().chain(&mut element.half_width);
            let points = element.points.iter_mut().filter(|_| element.variable == RegimeVariable::Reading);
            return values.chain(points).for_each(|number| *number *= by);
        }
        let along = match element.variable {
            RegimeVariable::Load => torque,
            RegimeVariable::Angle | RegimeVariable::Rate => turns,
            RegimeVariable::Turn
            | RegimeVariable::Control
            | RegimeVariable::Time
            | RegimeVariable::Reading => 1.0,
        };
        element.points.iter_mut().for_each(|point| *point *= along);
        if !element.quantity.is_factor() {
            element.values.iter_mut().chain(&mut element.half_width).for_each(|value| *value *= torque);
        }
    }

    /// Returns a recording as the scaled machine would have made it, in a loop of what `measured` says.
    pub fn recording(self, recording: &Recording, measured: FeedbackSignal) -> Recording {
        let mut out = recording.clone();
        let reading = self.reading(measured);
        let factors =
            [(Channel::MotorRate, self.ratio), (Channel::HubRate, reading), (Channel::Demand, reading)];
        for (channel, factor) in factors {
            out.samples_mut(channel).unwrap_or_default().iter_mut().for_each(|value| *value *= factor);
        }
        out
    }

    /// Returns the loop in which the scaled machine is replayed: under the recorded control if its readings are scaled, because a controller
    /// reads those of the machine itself. [`ReplayLoop::from_controller`] replays such a loop so anyway.
    pub fn replayed_loop(self, control: ReplayLoop, measured: FeedbackSignal) -> ReplayLoop {
        if self.reading(measured) == 1.0 { control } else { ReplayLoop::Open }
    }

    /// Converts the numbers of an answer back to the machine itself.
    pub fn bring_back(self, answer: &mut Answer, scaled: &Parameters) {
        let measured = scaled.sensors.measured;
        for finding in &mut answer.findings {
            for parameter in &mut finding.parameters {
                let found = find_parameter(finding.component, finding.effect, parameter.name);
                let Some(definition) = found else { continue };
                let own = |value: f64| self.original_value(scaled, definition, value);
                parameter.value = own(parameter.value);
                parameter.before = own(parameter.before);
                parameter.ci95 = parameter.ci95.map(own);
            }
            if let FindingBasis::NoKnownEffect { pattern: Some(pattern), .. } = &mut finding.basis
                && SCALED_REGIMES.contains(&pattern.regime)
            {
                pattern.trend = pattern.trend.map(Trend::without_numbers);
            }
        }
        for cell in answer.map.iter_mut().filter(|cell| SCALED_REGIMES.contains(&cell.regime)) {
            cell.trend = cell.trend.map(Trend::without_numbers);
        }
        for hypothesis in &mut answer.hypotheses {
            let (component, effect) = (hypothesis.component, hypothesis.effect);
            for value in &mut hypothesis.values {
                let found = find_parameter(component, effect, value.name);
                value.value = found
                    .map_or(value.value, |definition| self.original_value(scaled, definition, value.value));
            }
        }
        for effect in &mut answer.not_excited {
            let Some(definition) = find_parameter(effect.component, effect.effect, effect.parameter) else {
                continue;
            };
            effect.smallest_detectable =
                effect.smallest_detectable.map(|size| self.original_value(scaled, definition, size));
        }
        if let Some(learned) = &mut answer.learned {
            for part in &mut learned.parts {
                self.inverse().scale_element(&mut part.element);
                part.reading = read_curve(&part.element);
            }
            let tables = [&mut learned.after, &mut learned.held_out_before, &mut learned.held_out_after];
            tables.into_iter().for_each(|table| self.bring_channels_back(table, measured));
        }
        let fit = &mut answer.fit;
        for table in [&mut fit.before, &mut fit.after, &mut fit.held_out_before, &mut fit.held_out_after] {
            self.bring_channels_back(table, measured);
        }
    }

    fn bring_channels_back(self, table: &mut PooledFits, measured: FeedbackSignal) {
        for (channel, factor) in
            [(Channel::MotorRate, self.ratio), (Channel::HubRate, self.reading(measured))]
        {
            if let Some(fit) = table.get_mut(channel) {
                fit.rms_error /= factor;
                fit.floor /= factor;
            }
        }
    }

    /// Converts the value of a parameter on the scaled machine back to the machine itself.
    fn original_value(self, scaled: &Parameters, definition: &EffectParameter, value: f64) -> f64 {
        let mut probe = scaled.clone();
        definition.write(&mut probe, value);
        let taken = definition.read(&probe);
        let own = definition.read(&self.inverse().apply_to(&probe));
        let factor = own / taken;
        if factor.is_finite() && factor != 0.0 { value * factor } else { value }
    }
}

/// Returns the RMS of the motor's torque at the hub under the recorded control at standstill, N m.
fn drive_torque(base: &Parameters, recordings: &[Recording]) -> f64 {
    let drive = SteadyDrive::of(base);
    let gain = base.gearbox.ratio * base.motor.torque_constant_nm_a * drive.gain / drive.loss;
    let controls = recordings.iter().filter_map(|r| r.samples(Channel::Control)).flatten();
    let control: Vec<f64> = controls.copied().filter(|v| v.is_finite()).collect();
    (gain * crate::recording::series::rms(&control)).abs()
}

fn find_parameter(component: Component, effect: EffectName, name: &str) -> Option<&'static EffectParameter> {
    // the effects of such a machine come first: one whose friction starts from nothing also writes where the law has none
    let textbook =
        list_textbook_effects().into_iter().filter(|e| e.component == component && e.effect == effect);
    let mut definitions = textbook.chain(find_effects(component, effect)).flat_map(|e| e.parameters.iter());
    definitions.find(|definition| definition.name == name)
}

/// Scales the torques of equilibrator, stops and recoil: forces, and what makes them, by the factor.
fn set_loads(loads: &mut Loads, factor: f64) {
    if let Some(equilibrator) = &mut loads.equilibrator {
        match &mut equilibrator.force {
            Force::Spring { stiffness_n_m, .. } => *stiffness_n_m *= factor,
            Force::Gas(gas) => {
                gas.area_m2 *= factor;
                gas.volume_m3 *= factor;
            }
        }
    }
    if let Some(stops) = &mut loads.end_stops {
        stops.stiffness_nm_rad *= factor;
    }
    if let Some(recoil) = &mut loads.recoil {
        recoil.impulse_ns *= factor;
        recoil.mass_kg *= factor;
    }
}

/// Scales everything that a sensor states in the unit of its reading.
fn set_reading(sensor: &mut Sensor, factor: f64) {
    sensor.scale_v_unit /= factor;
    let Sensor { noise_rms, bias, g_sensitivity, resolution, drift, .. } = sensor;
    let Drift { angle_random_walk, bias_instability, rate_random_walk } = drift;
    let walks = [angle_random_walk, bias_instability, rate_random_walk];
    let stated = [noise_rms, bias, g_sensitivity, resolution].into_iter().chain(walks);
    stated.for_each(|value| *value *= factor);
}

/// Returns a ripple whose amplitude is a torque times `t`, over an angle times `r`.
fn ripple(ripple: &Ripple, t: f64, r: f64) -> Ripple {
    Ripple { amplitude: ripple.amplitude * t, order: ripple.order / r, phase_rad: ripple.phase_rad }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use counterpoise_controller::ProportionalIntegral;
    use counterpoise_models::parameters::cylinder::Lever;
    use counterpoise_models::reference::{put_cylinder, rig};
    use counterpoise_models::{EndStops, Plant};
    use counterpoise_simulate::{Detail, Imperfections, Scenario, Signal, Simulator};

    fn rates(machine: &Parameters) -> (Vec<f64>, Vec<f64>) {
        let plant = Plant::from_lumped(machine).unwrap();
        let bias_v = plant.equilibrium(&Default::default()).control_v;
        let sample_period_s = machine.interface.sample_period_s;
        let mut controller = ProportionalIntegral {
            kp_v_s_rad: 18.0,
            ki_v_rad: 80.0,
            bias_v,
            sample_period_s,
            ..ProportionalIntegral::default()
        };
        let scenario = Scenario {
            demand_rad_s: Signal::Triangle { amplitude: 0.15, period_s: 1.0 },
            imperfections: Imperfections::None,
            detail: Detail::Recording,
            ..Scenario::at_rest(1.0)
        };
        let run = Simulator::new(&plant).unwrap().run(&mut controller, &scenario).unwrap();
        (run.readings.hub_rate_rad_s().to_vec(), run.readings.control_v().to_vec())
    }

    #[test]
    fn a_scaled_machine_moves_alike_and_comes_back() {
        let rig = rig();
        let small = SimilarityScale { torque: 1e-4, ratio: 0.01 };
        let machine = small.apply_to(&rig);
        let ((rate, control), (rate_small, control_small)) = (rates(&rig), rates(&machine));
        let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
        assert!(apart(&rate, &rate_small) < 1e-4 * 0.15, "{}", apart(&rate, &rate_small));
        assert!(apart(&control, &control_small) < 1e-3, "{}", apart(&control, &control_small));
        let scale = SimilarityScale::of(&machine, &[]).unwrap();
        let usual = scale.apply_to(&machine);
        assert!((0.7..1.5).contains(&(usual.gearbox.ratio / USUAL_INERTIA_AND_RATIO.1)));
        assert_eq!(scale.inverse().apply_to(&usual), machine);
        assert!(SimilarityScale::of(&usual, &[]).is_none() && SimilarityScale::of(&rig, &[]).is_none());
        let definition = find_parameter(Component::Pivot, EffectName::Coulomb, "coulomb").unwrap();
        let own = scale.original_value(&usual, definition, usual.pivot_friction.coulomb_nm());
        assert!((own / machine.pivot_friction.coulomb_nm() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_machine_on_a_cylinder_moves_alike_with_its_own_lever() {
        let mut crane = rig();
        put_cylinder(&mut crane, Lever::Constant(0.3));
        let small = SimilarityScale { torque: 2f64.powi(-10), ratio: 1.0 }.apply_to(&crane);
        let scale = SimilarityScale::of(&small, &[]).unwrap();
        assert_eq!(scale.ratio, 1.0);
        let (own, usual) = (read_in_open_loop(&small), read_in_open_loop(&scale.apply_to(&small)));
        let largest = own.iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
        let off = own.iter().zip(&usual).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(largest > 1e-4 && off < 1e-3 * largest, "{off} of {largest} rad/s");
    }

    /// The reading of the loop's sensor under a control that is played back.
    fn read_in_open_loop(machine: &Parameters) -> Vec<f64> {
        let plant = Plant::from_lumped(machine).unwrap();
        let held = plant.equilibrium(&Default::default()).control_v;
        let control: Vec<f64> = (0..1000).map(|k| held + (0.03 * f64::from(k)).sin()).collect();
        let scenario = Scenario { detail: Detail::Recording, ..Scenario::at_rest(1.0) };
        let mut played = counterpoise_simulate::replay::Playback::new(&control);
        Simulator::new(&plant)
            .unwrap()
            .run(&mut played, &scenario)
            .unwrap()
            .readings
            .hub_rate_rad_s()
            .to_vec()
    }

    #[test]
    fn a_torque_is_read_scaled_and_comes_back_with_its_sensor_and_its_loads() {
        let mut rig = rig();
        rig.sensors.measured = FeedbackSignal::Torque;
        rig.sensors.hub_gyro = Sensor { noise_rms: 0.5, bias: 3.0, resolution: 0.25, ..Sensor::IDEAL };
        rig.loads.end_stops = Some(EndStops {
            lower_rad: -1e-3,
            upper_rad: 1e-3,
            stiffness_nm_rad: 2e5,
            dissipation_s_rad: 0.1,
        });
        let scale = SimilarityScale { torque: 2f64.powi(-12), ratio: 2f64.powi(-5) };
        let machine = scale.apply_to(&rig);
        let (of_rig, of_machine) = (read_in_open_loop(&rig), read_in_open_loop(&machine));
        let largest = of_rig.iter().map(|torque| (torque - of_rig[0]).abs()).fold(0.0, f64::max);
        let apart = |(a, b): (&f64, &f64)| (a - b / scale.torque).abs();
        let off = of_rig.iter().zip(&of_machine).map(apart).fold(0.0, f64::max);
        assert!(largest > 10.0 && off < 1e-3 * largest, "{off} of {largest} N m");
        assert_eq!(scale.inverse().apply_to(&machine), rig);
        let recording = Recording::new("", 1e-3).with(Channel::HubRate, of_machine.clone());
        let back = scale.inverse().recording(&recording, FeedbackSignal::Torque);
        let read = back.samples(Channel::HubRate).unwrap();
        assert!(read.iter().zip(&of_machine).all(|(back, own)| *back == own / scale.torque));
        assert_eq!(scale.inverse().recording(&recording, FeedbackSignal::Current), recording);
    }
}
