//! Changes of stored inputs, for tests that give a reader corrupted input.
#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Marsaglia's xorshift generator.
pub struct RandomGenerator(pub u64);

impl RandomGenerator {
    /// A whole number below `n`.
    pub fn draw_below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % n.max(1)
    }
}

/// Files below folders, in the order of their names.
pub fn corpus(folders: &[&str], endings: &[&str]) -> Vec<(PathBuf, Vec<u8>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut open: Vec<PathBuf> = folders.iter().map(|folder| root.join(folder)).collect();
    let mut found = Vec::new();
    while let Some(place) = open.pop() {
        for entry in std::fs::read_dir(place).into_iter().flatten() {
            let path = entry.unwrap().path();
            let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_owned();
            if path.is_dir() {
                open.push(path);
            } else if endings.contains(&ending.as_str()) {
                let bytes = std::fs::read(&path).unwrap();
                found.push((path, bytes));
            }
        }
    }
    found.sort();
    found
}

/// One of the inputs with some changes: bits, bytes, cuts, repetitions, pieces of another input, words that readers look for.
pub fn mutate_input(corpus: &[(PathBuf, Vec<u8>)], words: &[&[u8]], random: &mut RandomGenerator) -> Vec<u8> {
    let mut bytes = corpus[random.draw_below(corpus.len())].1.clone();
    for _ in 0..1 + random.draw_below(4) {
        if bytes.is_empty() {
            bytes.push(0);
        }
        let (at, length) = (random.draw_below(bytes.len()), 1 + random.draw_below(64));
        let end = (at + length).min(bytes.len());
        match random.draw_below(8) {
            0 => bytes[at] ^= 1 << random.draw_below(8),
            1 => bytes[at] = random.draw_below(256) as u8,
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..end)),
            4 => {
                let piece = bytes[at..end].to_vec();
                (0..1 + random.draw_below(20))
                    .for_each(|_| drop(bytes.splice(at..at, piece.iter().copied())));
            }
            5 => {
                let other = &corpus[random.draw_below(corpus.len())].1;
                let from = random.draw_below(other.len().max(1)).min(other.len());
                let to = (from + length).min(other.len());
                drop(bytes.splice(at..end, other[from..to].iter().copied()));
            }
            6 => drop(bytes.splice(at..end, words[random.draw_below(words.len())].iter().copied())),
            _ => bytes[at..end].fill([0, 0xff, b'9', b' '][random.draw_below(4)]),
        }
    }
    bytes
}

/// No input may take longer.
const SLOWEST: Duration = Duration::from_secs(10);

/// Returns the time that processors spent on this thread, so that a busy machine makes no input slow. Where the system does not say, it is the
/// time that passed.
fn processor_time() -> Duration {
    static BEGUN: OnceLock<Instant> = OnceLock::new();
    let passed = BEGUN.get_or_init(Instant::now).elapsed();
    let said = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = said.and_then(|text| text.split_whitespace().next()?.parse().ok());
    nanoseconds.map_or(passed, Duration::from_nanos)
}

/// Feeds stored inputs as they are, then changed ones for a while: `FUZZ_SECONDS` (default 2) seconds. Prints how many; returns it.
///
/// An input that makes `read` panic, or that takes longer than ten seconds of processor time, fails the test; it lies then in the
/// folder of temporary files under the target's name, to be added to the corpus.
pub fn fuzz(target: &str, corpus: &[(PathBuf, Vec<u8>)], words: &[&[u8]], read: &dyn Fn(&[u8])) -> usize {
    assert!(!corpus.is_empty(), "{target} has no corpus");
    let seconds = std::env::var("FUZZ_SECONDS").ok().and_then(|text| text.parse().ok()).unwrap_or(2_u64);
    let seed = std::env::var("FUZZ_SEED").ok().and_then(|text| text.parse().ok()).unwrap_or(1_u64);
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-{target}"));
    let mut slowest = Duration::ZERO;
    let mut one = |bytes: &[u8]| {
        let begun = processor_time();
        if let Err(panic) = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| read(bytes))) {
            std::fs::write(&kept, bytes).unwrap();
            std::panic::resume_unwind(panic);
        }
        let took = processor_time().saturating_sub(begun);
        slowest = slowest.max(took);
        if took > SLOWEST {
            std::fs::write(&kept, bytes).unwrap();
            panic!("{target}: an input took {took:?}");
        }
    };
    corpus.iter().for_each(|(_, bytes)| one(bytes));
    let mut random = RandomGenerator(0x2545_F491_4F6C_DD1D ^ seed);
    let (begun, mut count) = (Instant::now(), corpus.len());
    while begun.elapsed() < Duration::from_secs(seconds) {
        one(&mutate_input(corpus, words, &mut random));
        count += 1;
    }
    println!("{target}: {count} inputs in {seconds} s, seed {seed}, no failure, slowest {slowest:.1?}");
    count
}
