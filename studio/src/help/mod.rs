//! Help: what is under the pointer, what can be done on a page, and the terms of the glossary.
//!
//! Modules in reading order: [`glossary`], [`topics`], [`page_texts`], [`plot_texts`].

pub mod glossary;
pub mod page_texts;
pub mod plot_texts;
pub mod topics;
