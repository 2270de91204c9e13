//! The project file, and the one road from it to exported code.
