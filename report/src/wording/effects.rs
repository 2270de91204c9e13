//! The texts of the effects of the library.

use counterpoise_diagnose::library::{Component, EffectName};

/// Description of one entry of the library.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EffectText {
    /// Component.
    pub component: Component,
    /// Name.
    pub effect: EffectName,
    /// Name of its first parameter, which tells entries of one name apart.
    pub parameter: &'static str,
    /// Equation in words and symbols.
    pub equation: &'static str,
    /// The regime in which it shows; follows "it shows".
    pub regime: &'static str,
    /// An experiment that shows it clearly.
    pub experiment: &'static str,
}

/// Describes the entry of the library with a name and a first parameter; returns `None` if there is none.
pub fn describe_effect(
    component: Component,
    effect: EffectName,
    parameter: &str,
) -> Option<&'static EffectText> {
    if (component, effect) == (Component::Amplifier, EffectName::GainCurve)
        && parameter.starts_with(FREE_CURVE.parameter)
    {
        return Some(&FREE_CURVE);
    }
    let mut named = EFFECTS.iter().filter(|text| text.component == component && text.effect == effect);
    named.find(|text| text.parameter == parameter)
}

/// Returns the experiment that shows an effect clearly: of entries of one name, that of the first.
pub fn experiment_for(component: Component, effect: EffectName) -> Option<&'static str> {
    let mut named = EFFECTS.iter().filter(|text| text.component == component && text.effect == effect);
    named.next().map(|text| text.experiment)
}

/// The amplifier's curve with a free point at each of some inputs; its parameters are named after the inputs.
const FREE_CURVE: EffectText = EffectText {
    component: Component::Amplifier,
    effect: EffectName::GainCurve,
    parameter: "gain at",
    equation: "current = odd, piecewise linear map of the input; each point as a fraction of the linear gain",
    regime: "at small control voltages, whatever the rate",
    experiment: "stalled amplifier map, or runs at two out-of-balances",
};

/// Every entry, in the order of the library.
const EFFECTS: &[EffectText] = &[
    EffectText {
        component: Component::Structure,
        effect: EffectName::OutOfBalance,
        parameter: "out_of_balance",
        equation: "T_oob = (g + a_p) (mu cos theta_h - nu sin theta_h), another mu",
        regime: "always: constant torque at rest, and in proportion to heave",
        experiment: "hold still at two elevations, or drive the platform in heave",
    },
    EffectText {
        component: Component::Structure,
        effect: EffectName::VerticalOffset,
        parameter: "vertical_offset",
        equation: "T_oob = (g + a_p) (mu cos theta_h - nu sin theta_h), another nu",
        regime: "away from level: torque in proportion to the inertial hub angle",
        experiment: "slow travel over the whole elevation range, with the platform level and tilted",
    },
    EffectText {
        component: Component::Structure,
        effect: EffectName::Inertia,
        parameter: "beam_inertia",
        equation: "J theta'' = torques, another beam inertia",
        regime: "in proportion to angular acceleration",
        experiment: "multisine or triangle demand with the platform still",
    },
    EffectText {
        component: Component::Structure,
        effect: EffectName::Inertia,
        parameter: "hub_inertia",
        equation: "J theta'' = torques, another hub inertia",
        regime: "in proportion to angular acceleration",
        experiment: "multisine or triangle demand with the platform still",
    },
    EffectText {
        component: Component::Structure,
        effect: EffectName::PositionStiffness,
        parameter: "stiffness",
        equation: "T = -k (theta_h - theta_p - centre): a cable or hose between hub and platform",
        regime: "in proportion to the hub's position on the platform",
        experiment: "slow travel over the whole range; tilt of the platform distinguishes it from gravity",
    },
    EffectText {
        component: Component::Structure,
        effect: EffectName::Hysteresis,
        parameter: "level",
        equation: "dT/dt = k (w - |w| T / (2 T_max) - w |T| / (2 T_max)): a hose between hub and platform that yields",
        regime: "after a reversal, over an angle that does not depend on the rate",
        experiment: "slow travel with reversals after long and after short ways",
    },
    EffectText {
        component: Component::Structure,
        effect: EffectName::Equilibrator,
        parameter: "factor",
        equation: "T = factor x F r R sin(c) / L, another factor: a gas of another temperature or charge, another spring",
        regime: "with the hub's position on the platform, as the lever of the equilibrator goes",
        experiment: "slow travel over the whole range, at the temperature in question",
    },
    EffectText {
        component: Component::Structure,
        effect: EffectName::EndStops,
        parameter: "stop_stiffness",
        equation: "T = k d (1 + c v) at a stop, another k",
        regime: "beyond the ends of the travel",
        experiment: "slow travel against a stop, and a rebound from it",
    },
    EffectText {
        component: Component::Structure,
        effect: EffectName::Recoil,
        parameter: "recoil_height",
        equation: "T = e K + o B + m x G + 2 m (b - x) v w_h, another height e of the recoiling mass",
        regime: "while the recoiling mass moves",
        experiment: "single shots with the platform still",
    },
    EffectText {
        component: Component::Structure,
        effect: EffectName::FlexibleMode,
        parameter: "stiffness",
        equation: "K_h (theta_h - theta_b) between hub and beam, another stiffness",
        regime: "near the structure's first resonance",
        experiment: "multisine around the first resonance",
    },
    EffectText {
        component: Component::Structure,
        effect: EffectName::FlexibleMode,
        parameter: "damping",
        equation: "D_h (theta_h' - theta_b') between hub and beam, another damping",
        regime: "near the structure's first resonance",
        experiment: "multisine around the first resonance",
    },
    EffectText {
        component: Component::Pivot,
        effect: EffectName::Coulomb,
        parameter: "coulomb",
        equation: "F_c sgn(w) when sliding, another level",
        regime: "at every reversal of the hub's motion on the platform",
        experiment: "triangle demand; platform motion with the hub held still",
    },
    EffectText {
        component: Component::Pivot,
        effect: EffectName::Viscous,
        parameter: "viscous",
        equation: "F_v w, another coefficient",
        regime: "in proportion to the hub's rate on the platform",
        experiment: "constant rates, both ways, several speeds",
    },
    EffectText {
        component: Component::Pivot,
        effect: EffectName::Stribeck,
        parameter: "static_ratio",
        equation: "dry friction F_c (1 + (ratio - 1) exp(-(w / v_s)^2))",
        regime: "near zero rate of the hub on the platform, below about v_s",
        experiment: "constant-rate ladder from well below to well above v_s",
    },
    EffectText {
        component: Component::Pivot,
        effect: EffectName::AsymmetricFriction,
        parameter: "asymmetry",
        equation: "dry friction F_c (1 + a sgn(w))",
        regime: "different in the two directions of motion",
        experiment: "triangle demand at two out-of-balances",
    },
    EffectText {
        component: Component::Pivot,
        effect: EffectName::AsymmetricFriction,
        parameter: "viscous_asymmetry",
        equation: "viscous part F_v (1 + a sgn(w)) w",
        regime: "different in the two directions of motion, in proportion to the rate",
        experiment: "constant rates, both ways, several speeds",
    },
    EffectText {
        component: Component::Pivot,
        effect: EffectName::PositionDependentFriction,
        parameter: "amplitude",
        equation: "dry friction F_c (1 + a sin(n theta + phase)), theta the hub's angle on the platform",
        regime: "repeats with the hub's angle on the platform",
        experiment: "slow travel over the whole range, both ways",
    },
    EffectText {
        component: Component::Pivot,
        effect: EffectName::PreslidingStiffness,
        parameter: "rest_stiffness",
        equation: "sigma of Dahl's law, another value",
        regime: "in the first fraction of a milliradian after every reversal",
        experiment: "sine below breakaway at several amplitudes",
    },
    EffectText {
        component: Component::Pivot,
        effect: EffectName::QuadraticDrag,
        parameter: "quadratic",
        equation: "c w |w|",
        regime: "at the highest rates of the hub on the platform",
        experiment: "constant-rate ladder up to the highest rate",
    },
    EffectText {
        component: Component::Pivot,
        effect: EffectName::LoadDependentFriction,
        parameter: "load_coefficient",
        equation: "dry friction F_c + c |T|, T the torque carried",
        regime: "where the torque carried varies: heave, or several out-of-balances",
        experiment: "the same triangle at several out-of-balances",
    },
    EffectText {
        component: Component::Pivot,
        effect: EffectName::WarmUp,
        parameter: "warm_up",
        equation: "level (1 + a (exp(-t / tau) - 1))",
        regime: "drifts over the recording, whatever the motion",
        experiment: "the same triangle after rest and after ten minutes of motion",
    },
    EffectText {
        component: Component::Motor,
        effect: EffectName::Coulomb,
        parameter: "coulomb",
        equation: "F_c sgn(w_m) at the motor shaft, another level",
        regime: "at every reversal of the motor",
        experiment: "triangle demand with the platform still, then platform motion with the hub held still",
    },
    EffectText {
        component: Component::Motor,
        effect: EffectName::Viscous,
        parameter: "viscous",
        equation: "F_v w_m at the motor shaft, another coefficient",
        regime: "in proportion to motor speed",
        experiment: "constant rates, both ways, several speeds",
    },
    EffectText {
        component: Component::Motor,
        effect: EffectName::Cogging,
        parameter: "amplitude",
        equation: "torque A sin(n theta_m + phase) on the motor shaft, with or without current",
        regime: "repeats with the motor's angle",
        experiment: "slow constant rate over several motor turns, both ways",
    },
    EffectText {
        component: Component::Motor,
        effect: EffectName::TorqueRipple,
        parameter: "amplitude",
        equation: "torque constant K_t (1 + A sin(n theta_m + phase))",
        regime: "repeats with the motor's angle, in proportion to current",
        experiment: "slow constant rate over several motor turns at two out-of-balances",
    },
    EffectText {
        component: Component::Motor,
        effect: EffectName::TorqueConstant,
        parameter: "torque_constant",
        equation: "T_m = K_t i, another K_t",
        regime: "in proportion to motor torque",
        experiment: "hold still at two known out-of-balances",
    },
    EffectText {
        component: Component::Gearbox,
        effect: EffectName::Backlash,
        parameter: "backlash",
        equation: "T_2 = K deadzone(delta, b / 2), another gap b",
        regime: "when the mesh torque changes sign",
        experiment: "torque reversals with the mechanism balanced",
    },
    EffectText {
        component: Component::Gearbox,
        effect: EffectName::Stiffness,
        parameter: "stiffness",
        equation: "T_2 = K deadzone(delta, b / 2), another K",
        regime: "near the resonance of the drive",
        experiment: "multisine around the drive's resonance",
    },
    EffectText {
        component: Component::Gearbox,
        effect: EffectName::MeshRipple,
        parameter: "amplitude",
        equation: "torque A sin(n theta_m + phase) on the hub",
        regime: "repeats with the motor's angle, felt at the hub",
        experiment: "slow constant rate over several motor turns, both ways",
    },
    EffectText {
        component: Component::Gearbox,
        effect: EffectName::MeshEfficiency,
        parameter: "efficiency",
        equation: "a fraction of the mesh torque is lost on the driven side",
        regime: "in proportion to the mesh torque, changing with the direction of power",
        experiment: "the same triangle at several out-of-balances",
    },
    EffectText {
        component: Component::Amplifier,
        effect: EffectName::GainCurve,
        parameter: "depth",
        equation: "gain of the amplifier x (1 - depth exp(-(|v| / corner)^3)): another gain at small inputs",
        regime: "at small control voltages, whatever the rate",
        experiment: "stalled amplifier map, or runs at two out-of-balances",
    },
    EffectText {
        component: Component::Amplifier,
        effect: EffectName::DeadZone,
        parameter: "dead_zone",
        equation: "no output for |v| below c, v - c sgn(v) beyond",
        regime: "at small control voltages",
        experiment: "stalled amplifier map, or runs at two out-of-balances",
    },
    EffectText {
        component: Component::Amplifier,
        effect: EffectName::ContinuousCurrent,
        parameter: "continuous_current",
        equation: "i^2 <= i_c^2 + f (i_p^2 - i_c^2), f = (1 - average of i^2/i_c^2)/0.1: another i_c",
        regime: "after large currents have lasted, at large control voltages",
        experiment: "large currents for longer than the drive's overload time",
    },
    EffectText {
        component: Component::Amplifier,
        effect: EffectName::CurrentLimit,
        parameter: "current_limit",
        equation: "|i| does not exceed a limit",
        regime: "at the largest currents",
        experiment: "the largest steps that travel allows",
    },
    EffectText {
        component: Component::Amplifier,
        effect: EffectName::Bandwidth,
        parameter: "time_constant",
        equation: "tau_a dV/dt = -V + ..., another tau_a",
        regime: "at the highest frequencies",
        experiment: "multisine to the highest frequency",
    },
    EffectText {
        component: Component::Control,
        effect: EffectName::Delay,
        parameter: "delay",
        equation: "the control reaches the amplifier d samples late",
        regime: "in proportion to frequency",
        experiment: "multisine to the highest frequency",
    },
    EffectText {
        component: Component::HubGyro,
        effect: EffectName::Scale,
        parameter: "gain",
        equation: "reading = gain x rate",
        regime: "in proportion to hub rate",
        experiment: "constant rates against the resolver",
    },
    EffectText {
        component: Component::HubGyro,
        effect: EffectName::Bias,
        parameter: "bias",
        equation: "reading = rate + bias",
        regime: "always, constant",
        experiment: "stand still",
    },
    EffectText {
        component: Component::HubGyro,
        effect: EffectName::Bandwidth,
        parameter: "natural_frequency",
        equation: "second-order lag of another natural frequency",
        regime: "at the highest frequencies",
        experiment: "multisine to the highest frequency",
    },
    EffectText {
        component: Component::HubGyro,
        effect: EffectName::Delay,
        parameter: "delay",
        equation: "reading late by a time",
        regime: "in proportion to frequency",
        experiment: "multisine to the highest frequency, against the tachometer",
    },
    EffectText {
        component: Component::HubGyro,
        effect: EffectName::GSensitivity,
        parameter: "g_sensitivity",
        equation: "reading = rate + c a_p",
        regime: "in proportion to heave",
        experiment: "heave with the hub locked",
    },
    EffectText {
        component: Component::PlatformGyro,
        effect: EffectName::Scale,
        parameter: "gain",
        equation: "reading = gain x rate",
        regime: "in proportion to platform rate",
        experiment: "platform pitch with the hub held on the platform",
    },
    EffectText {
        component: Component::PlatformGyro,
        effect: EffectName::Bias,
        parameter: "bias",
        equation: "reading = rate + bias",
        regime: "always, constant",
        experiment: "stand still",
    },
    EffectText {
        component: Component::PlatformGyro,
        effect: EffectName::Bandwidth,
        parameter: "natural_frequency",
        equation: "second-order lag of another natural frequency",
        regime: "at the highest frequencies of the platform",
        experiment: "platform pitch to the highest frequency",
    },
    EffectText {
        component: Component::PlatformGyro,
        effect: EffectName::Delay,
        parameter: "delay",
        equation: "reading late by a time",
        regime: "in proportion to the platform's frequency",
        experiment: "platform pitch to the highest frequency",
    },
    EffectText {
        component: Component::PlatformGyro,
        effect: EffectName::GSensitivity,
        parameter: "g_sensitivity",
        equation: "reading = rate + c a_p",
        regime: "in proportion to heave",
        experiment: "pure heave",
    },
    EffectText {
        component: Component::PlatformAccelerometer,
        effect: EffectName::Scale,
        parameter: "gain",
        equation: "reading = gain x heave",
        regime: "in proportion to heave",
        experiment: "heave of known size",
    },
    EffectText {
        component: Component::PlatformAccelerometer,
        effect: EffectName::Bias,
        parameter: "bias",
        equation: "reading = heave + bias",
        regime: "always, constant",
        experiment: "stand still",
    },
    EffectText {
        component: Component::PlatformAccelerometer,
        effect: EffectName::LeverArm,
        parameter: "lever_arm",
        equation: "reading = heave + arm x pitch acceleration",
        regime: "in proportion to pitch acceleration",
        experiment: "pure platform pitch",
    },
    EffectText {
        component: Component::HubGyro,
        effect: EffectName::Misalignment,
        parameter: "roll_sensitivity",
        equation: "reading = rate + c_r w_f + c_y w_u, with the rates about the beam and about its normal",
        regime: "in proportion to roll and yaw of the platform",
        experiment: "roll and yaw of the platform with the hub held on it",
    },
    EffectText {
        component: Component::PlatformGyro,
        effect: EffectName::Misalignment,
        parameter: "roll_sensitivity",
        equation: "reading = pitch rate + c_r w_f + c_y w_u, with the platform's roll and yaw rates",
        regime: "in proportion to roll and yaw of the platform",
        experiment: "pure roll and pure yaw of the platform",
    },
    EffectText {
        component: Component::PlatformAccelerometer,
        effect: EffectName::Tilt,
        parameter: "tilt",
        equation: "reading = a cos(t) - a_x sin(t) + g (cos(t) - 1), with heave a, surge a_x and tilt t",
        regime: "in proportion to surge",
        experiment: "pure surge",
    },
    EffectText {
        component: Component::Platform,
        effect: EffectName::ChannelSkew,
        parameter: "skew",
        equation: "the platform's channels are recorded late by a time",
        regime: "in proportion to the platform's frequency",
        experiment: "platform pitch to the highest frequency",
    },
    EffectText {
        component: Component::Gearbox,
        effect: EffectName::Damping,
        parameter: "damping",
        equation: "T_2 = K delta + D delta', another D",
        regime: "near the resonance of the drive",
        experiment: "multisine around the drive's resonance",
    },
    EffectText {
        component: Component::Motor,
        effect: EffectName::Inertia,
        parameter: "motor_inertia",
        equation: "J_m w_m' = torques at the motor shaft, another J_m",
        regime: "in proportion to the motor's acceleration",
        experiment: "multisine to the highest frequency",
    },
    EffectText {
        component: Component::Motor,
        effect: EffectName::AsymmetricFriction,
        parameter: "asymmetry",
        equation: "dry friction F_c (1 + a sgn(w_m)) at the motor shaft",
        regime: "differs between the two directions of motion",
        experiment: "slow constant rate in both directions",
    },
    EffectText {
        component: Component::Motor,
        effect: EffectName::AsymmetricFriction,
        parameter: "viscous_asymmetry",
        equation: "viscous part F_v (1 + a sgn(w_m)) w_m at the motor shaft",
        regime: "differs between the two directions, in proportion to the rate",
        experiment: "constant rates in both directions",
    },
    EffectText {
        component: Component::Motor,
        effect: EffectName::Stribeck,
        parameter: "static_ratio",
        equation: "dry friction F_c (1 + (ratio - 1) exp(-(w_m / v_s)^2)) at the motor shaft",
        regime: "near zero motor rate",
        experiment: "slow reversals of the motor",
    },
    EffectText {
        component: Component::Motor,
        effect: EffectName::BackEmf,
        parameter: "back_emf_constant",
        equation: "e = K_e w_m, another K_e",
        regime: "in proportion to the motor's rate",
        experiment: "constant rates up to the highest",
    },
    EffectText {
        component: Component::Motor,
        effect: EffectName::Resistance,
        parameter: "resistance",
        equation: "R i = V - K_e w_m, another R",
        regime: "in proportion to current",
        experiment: "stalled motor at several voltages",
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use counterpoise_diagnose::library::{list_effects, list_textbook_effects, make_free_gain_curve};

    #[test]
    fn every_entry_of_the_library_has_its_text() {
        for entry in list_effects().into_iter().chain(list_textbook_effects()).chain([make_free_gain_curve()])
        {
            let parameter = entry.parameters[0].name;
            let text = describe_effect(entry.component, entry.effect, parameter);
            assert!(text.is_some(), "{} {} {parameter}", entry.component, entry.effect);
            assert!(experiment_for(entry.component, entry.effect).is_some());
        }
    }
}
