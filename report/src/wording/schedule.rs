//! The schedule over out-of-balance in words: which conditions hold in a state of balance, and what follows.

use counterpoise_synth::tolerance::EQUAL;
use counterpoise_synth::{Conditions, HeaveFeedforwardLaw};

/// Describes which conditions of the gain law hold.
pub fn describe_conditions(found: &Conditions) -> String {
    if found.hold() && found.feedback_stays() {
        return "inertia kept, heave torque in proportion: all conditions of the gain law hold".to_owned();
    }
    let mut words = Vec::new();
    let mut say = |what: &str, deviation: f64| {
        if deviation > EQUAL {
            words.push(format!("{what} differs by {:.2} %", 100.0 * deviation));
        }
    };
    say("the path from control to rates (inertia, structure)", found.path_deviation);
    say("the pitch path", found.pitch_deviation);
    say("the heave path, scaled by the out-of-balance,", found.proportion_deviation);
    say("the noise that the feedback assumes", found.noise_deviation);
    words.join("; ")
}

/// Describes what becomes of the heave feedforward.
pub fn describe_law(law: &HeaveFeedforwardLaw) -> String {
    match law {
        HeaveFeedforwardLaw::ExactGain { factor } => format!("gain {factor:.4}, exact by theory"),
        HeaveFeedforwardLaw::NearlyGain { factor, deviation } => {
            format!("gain {factor:.4}, within {:.2} % of the redesign", 100.0 * deviation)
        }
        HeaveFeedforwardLaw::Redesign { deviation } if deviation.is_finite() => {
            format!("redesign: a gain would be {:.1} % off", 100.0 * deviation)
        }
        HeaveFeedforwardLaw::Redesign { .. } => {
            "redesign: there is no gain from a nominal imbalance of 0".to_owned()
        }
    }
}
