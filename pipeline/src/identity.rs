//! The project that a result belongs to.

use counterpoise_project::Project;

use crate::World;
use crate::export::project_hash;

/// Project to which a result belongs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProjectIdentity {
    /// Name of the mechanism.
    pub name: String,
    /// Hash of the project as it was resolved.
    pub hash: String,
}

impl ProjectIdentity {
    /// Returns the identity of a project.
    pub fn of(project: &Project, world: &dyn World) -> Self {
        Self { name: project.plant.name.clone(), hash: project_hash(project, world) }
    }
}
