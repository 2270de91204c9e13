//! Ctrl-C: a command that can stop in good order is asked to; every other one ends at once. The exit code is the same.

use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);
static WATCHED: AtomicBool = AtomicBool::new(false);
/// Exit code of a program that Ctrl-C ended, as shells have it.
pub const INTERRUPTED: u8 = 130;

/// Work that ended because the user asked it to stop; says what was kept.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Interruption(pub String);

/// Installs a handler: from here on, Ctrl-C ends the program with [`INTERRUPTED`], but while work is [watched](watch_interrupts). Where no
/// handler can be set, the system ends the program, as it would have.
pub fn install_handler() {
    let handler = || {
        if !WATCHED.load(Ordering::SeqCst) || ASKED.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(INTERRUPTED));
        }
        crate::terminal::print_message("\nstopping (Ctrl-C again to stop at once)");
    };
    let _ = ctrlc::set_handler(handler);
}

/// Work during which the first Ctrl-C asks to stop, and the second ends the program; afterwards the first ends it again.
#[must_use = "the work is watched for as long as this value lives"]
pub struct InterruptGuard(());

/// Begins work that looks at [`is_stop_requested`] often enough to stop soon.
pub fn watch_interrupts() -> InterruptGuard {
    WATCHED.store(true, Ordering::SeqCst);
    InterruptGuard(())
}

impl Drop for InterruptGuard {
    fn drop(&mut self) {
        WATCHED.store(false, Ordering::SeqCst);
    }
}

/// Returns whether the user asked to stop.
pub fn is_stop_requested() -> bool {
    ASKED.load(Ordering::SeqCst)
}
