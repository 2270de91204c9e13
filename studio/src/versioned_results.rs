//! Results with the revision of the project that they came from.

/// A result and the revision of the project that it came from.
#[derive(Debug, Clone)]
pub struct VersionedResult<T> {
    /// The revision.
    pub revision: u64,
    /// The result.
    pub value: T,
}

/// Relation of a result to the project as it stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Freshness {
    /// The result belongs to the project as it stands.
    Current,
    /// The result belongs to an older revision.
    Stale,
}

impl<T> VersionedResult<T> {
    /// Returns whether the result belongs to this revision of the project.
    pub fn freshness(&self, project_revision: u64) -> Freshness {
        if self.revision == project_revision { Freshness::Current } else { Freshness::Stale }
    }
}
