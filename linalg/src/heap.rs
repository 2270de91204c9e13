//! Freed memory that is kept for the matrices that follow.

use std::hint::black_box;
use std::sync::Once;

/// Rows of a matrix from which on one temporary matrix exceeds the blocks that the allocator of GNU keeps, 128 KiB.
const LARGE: usize = 96;

/// Bytes of the block that is freed once: below the limit of the allocator's own adaptation, 32 MiB.
const BLOCK: usize = 31 << 20;

/// Lets the allocator keep the blocks of temporary matrices of `rows` rows if these are large.
///
/// The allocator of GNU returns a large block to the system as soon as it is freed, and the next matrix of the same size is then made of new
/// pages, each cleared by the system: a tenth of the time of a Riccati equation with 200 states. It keeps blocks up to the size of the largest
/// that was ever freed (mallopt(3), `M_MMAP_THRESHOLD`). One block that is never written costs no memory and raises that limit once. Other
/// allocators do not change.
pub(crate) fn keep_freed_blocks(rows: usize) {
    static ONCE: Once = Once::new();
    if rows >= LARGE {
        ONCE.call_once(|| {
            let mut block = Vec::<u8>::new();
            // Without the block, matrices are as slow as before.
            let _ = block.try_reserve_exact(BLOCK);
            black_box(&block);
        });
    }
}
