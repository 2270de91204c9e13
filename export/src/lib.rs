//! The verified controller as source code.
