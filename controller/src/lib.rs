//! The discrete controller as it runs on the target, operation by operation.
