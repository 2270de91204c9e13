//! The data that the printed guard of a controller needs: limits of the readings, states to look after, and the mark of the set.

use counterpoise_controller::guard::{ALONE, REFUSED, RESTARTED, STICKY};
use counterpoise_controller::program::{OnRestart, StateGroup};
use counterpoise_controller::tolerance::{FLUSHED_DOUBLE, FLUSHED_SINGLE, MOST_STATES};
use counterpoise_controller::{Controller, GuardSettings};
use minijinja::{Value, context};

use crate::print::{Dialect, literal};
use crate::{File, Precision};

/// Words of a guard beside one for each reading: the count of replaced readings, and the flags.
const GUARD_WORDS: usize = 2;
/// Real numbers of a guard beside the last good readings: the control, and the share of the other sensors.
const GUARD_NUMBERS: usize = 2;

/// Instructions that the guard of a reading needs, about.
const A_READING: usize = 45;
/// Instructions that looking after a state needs, about.
const A_STATE: usize = 15;

/// Returns bytes of memory that the guard of a controller takes.
pub(crate) fn guard_bytes(controller: &Controller, number_bytes: usize) -> usize {
    let readings = controller.parts().reading_count();
    (readings + GUARD_NUMBERS) * number_bytes + 4 * (readings + GUARD_WORDS)
}

/// Instructions that the guard of a controller adds to a step, about.
pub(crate) fn guard_instructions(controller: &Controller) -> usize {
    controller.parts().reading_count() * A_READING + controller.programs().state_count() * A_STATE
}

/// Returns what every template needs of the guard: the flags as hexadecimal literals, and counts.
pub(crate) fn flags(controller: &Controller) -> Value {
    let settings = GuardSettings::of(controller.parts());
    let bit = |mask: u32| format!("0x{mask:X}");
    context! {
        replaced => bit(settings.replaced_mask()), unchanged => bit(settings.unchanged_mask()), restarted => bit(RESTARTED),
        refused => bit(REFUSED), alone => bit(ALONE), sticky => bit(STICKY),
        unchanged_samples => settings.unchanged_samples,
    }
}

/// Returns what templates in floating point need besides.
pub(crate) fn guard(controller: &Controller, precision: Precision, dialect: Dialect) -> Value {
    let settings = GuardSettings::of(controller.parts());
    let text = |value: f64| literal(value, precision, dialect);
    let tiny = if precision == Precision::Double { FLUSHED_DOUBLE } else { FLUSHED_SINGLE };
    let groups = &controller.programs().states;
    context! {
        limits => settings.limits.iter().take(settings.readings).map(|limit| text(*limit)).collect::<Vec<_>>(),
        share_step => text(settings.share_step),
        tiny => text(tiny),
        most => text(MOST_STATES),
        zero => text(0.0),
        one => text(1.0),
        tended => groups.iter().map(group).collect::<Vec<_>>(),
        kept => groups.iter().filter(|group| group.on_restart == OnRestart::Keep).map(group).collect::<Vec<_>>(),
        limited => groups.iter().filter_map(|group| limited_state(group, &text)).collect::<Vec<_>>(),
    }
}

fn group(group: &StateGroup) -> Value {
    context! { name => group.name.as_str(), length => group.length }
}

/// Returns a state with its limits. Only single states have any.
fn limited_state(group: &StateGroup, text: &dyn Fn(f64) -> String) -> Option<Value> {
    let limits = group.limits?;
    Some(context! { name => group.name.as_str(), low => text(limits.low), high => text(limits.high) })
}

/// The text that stands in the files of a set until their mark is known.
pub(crate) const MARK: &str = "@SET@";

/// Puts the mark of a set into its files: a hash of all of them (FNV-1a, 64 bits). A file that is compiled with one of another
/// set finds another mark and stops the compiler.
pub(crate) fn mark_files(mut files: Vec<File>) -> Vec<File> {
    let bytes = files.iter().flat_map(|file| file.name.bytes().chain([0]).chain(file.text.bytes()));
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let mark = format!("{hash:016x}");
    files.iter_mut().for_each(|file| file.text = file.text.replace(MARK, &mark));
    files
}
