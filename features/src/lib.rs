//! One choice of features for the dependencies that several programs share.
//!
//! Cargo compiles a dependency anew for every choice of its features. Without this package the command line and the whole workspace, with
//! its window and its tests, choose differently for ten small packages, and as most others stand on these, nearly everything is compiled
//! twice. The lowest crates of the workspace depend on this package, so that every selection of packages makes the same choice.
//!
//! *Invariant*: there is no code here; the manifest is all.
