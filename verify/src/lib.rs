//! Figures, limits and verdicts.
