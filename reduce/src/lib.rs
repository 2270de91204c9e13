//! Model reduction with its error.
