//! Journals that were damaged: reading one never panics, and what is recovered from a cut one is a beginning of what was noted.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../../tests/tests/support/mutate.rs"]
mod mutate;

use std::path::Path;

use counterpoise_studio::editing::journal::recover_journal;
use mutate::fuzz;

#[test]
fn damaged_journals() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzzed.journal");
    let whole = "{\"project\":\"rig.toml\",\"text\":\"[plant]\\n\"}\n\"undo\"\n{\"set_text\":{\"path\":\"plant.name\",\"value\":\"x\"}}\n\"redo\"\n";
    let words: [&[u8]; 6] = [b"\n", b"{\"set", b"\"undo\"", b"}", b"\xff", b"[[[["];
    let stored = vec![(path.clone(), whole.as_bytes().to_vec()), (path.clone(), Vec::new())];
    fuzz("journal", &stored, &words, &|bytes| {
        std::fs::write(&path, bytes).unwrap();
        drop(recover_journal(&path));
    });
    let count = |length: usize| {
        std::fs::write(&path, &whole.as_bytes()[..length]).unwrap();
        recover_journal(&path).map_or(0, |found| found.commands.len())
    };
    let counts: Vec<usize> = (0..=whole.len()).map(count).collect();
    assert!(counts.windows(2).all(|pair| pair[0] <= pair[1] + 1));
}
